# Writes Version.hpp with the project's version and the git hash ('unknown' in a source archive).
set(hash unknown)
find_package(Git QUIET)
if(GIT_FOUND AND EXISTS ${SOURCE_DIR}/.git)
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE_DIR} describe --always --dirty --abbrev=12
                  OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE
                  RESULT_VARIABLE failed ERROR_QUIET)
  if(NOT failed)
    set(hash ${described})
  endif()
endif()
file(WRITE ${OUTPUT}.new "#pragma once\n\nnamespace mpm {\n"
  "inline constexpr char version[] = \"${PROJECT_VERSION}\";\n"
  "inline constexpr char git_hash[] = \"${hash}\";\n}  // namespace mpm\n")
execute_process(COMMAND ${CMAKE_COMMAND} -E copy_if_different ${OUTPUT}.new ${OUTPUT})

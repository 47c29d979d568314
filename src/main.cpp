#include <fmt/format.h>

#include <vector>

#include "mpm/scene/Application.hpp"

int main(int argc, char** argv) {
  const std::vector<const char*> arguments(argv + 1, argv + argc);
  return static_cast<int>(mpm::scene::run_application(arguments));
}

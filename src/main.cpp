#include <fmt/format.h>

#include <vector>

#include "mpm/app/Application.hpp"

int main(int argc, char** argv) {
  const std::vector<const char*> arguments(argv + 1, argv + argc);
  return static_cast<int>(mpm::app::run_application(arguments));
}

#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <array>
#include <filesystem>
#include <string>

#include "support/World.hpp"

namespace mpm::test {

/// A directory of all ranks that is gone afterwards.
class SharedDirectory {
 public:
  SharedDirectory() {
    std::array<char, 256> path{};
    const auto pattern = std::filesystem::temp_directory_path() / "mpm_output_test_XXXXXX";
    pattern.string().copy(path.data(), path.size() - 1);
    if (world_rank() == 0) {
      EXPECT_NE(mkdtemp(path.data()), nullptr);
    }
    MPI_Bcast(path.data(), static_cast<int>(path.size()), MPI_CHAR, 0, world());
    m_path = path.data();
  }
  ~SharedDirectory() {
    world().barrier();
    if (world_rank() == 0) std::filesystem::remove_all(m_path);
  }
  std::string path(const std::string& name) const { return m_path + "/" + name; }
  const std::string& path() const { return m_path; }

 private:
  std::string m_path;
};

}  // namespace mpm::test

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <exception>

#include "mpm/petsc/Session.hpp"

namespace {

/// On ranks other than the first: nothing but failures, each with its rank.
class FailuresOnly : public testing::EmptyTestEventListener {
 public:
  explicit FailuresOnly(int rank) : m_rank(rank) {}

  void OnTestStart(const testing::TestInfo& test) override { m_test = &test; }

  /// Called with GoogleTest's lock held: asking it for the current test would wait for ever.
  void OnTestPartResult(const testing::TestPartResult& result) override {
    if (!result.failed()) return;
    std::fprintf(stderr, "rank %d: %s:%d: %s.%s\n%s\n", m_rank,
                 result.file_name() != nullptr ? result.file_name() : "?", result.line_number(),
                 m_test != nullptr ? m_test->test_suite_name() : "?",
                 m_test != nullptr ? m_test->name() : "?", result.summary());
  }

 private:
  int m_rank;
  const testing::TestInfo* m_test = nullptr;
};

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  GTEST_FLAG_SET(catch_exceptions, false);  // one rank would go on while the others wait
  const std::vector<std::pair<std::string, std::string>> options{{"no_signal_handler", ""}};
  const mpm::petsc::Session session(options);
  auto& listeners = testing::UnitTest::GetInstance()->listeners();
  if (session.rank() > 0) {
    delete listeners.Release(listeners.default_result_printer());
    listeners.Append(new FailuresOnly(session.rank()));
  }
  try {
    const int mine = RUN_ALL_TESTS();
    return mpm::petsc::maximum(static_cast<double>(mine)) > 0.0 ? 1 : 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rank %d: unexpected exception: %s\n", session.rank(), error.what());
    MPI_Abort(mpm::petsc::world(), 1);
  }
}

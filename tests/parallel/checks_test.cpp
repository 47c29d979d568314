#include "mpm/run/Checks.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "mpm/core/Errors.hpp"

namespace mpm::run {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// One check with limits that are not those of any scene.
struct Sample {
  Checks checks{{{.name = "side_wall",
                  .limits = {0.3, 0.7},
                  .sentence = "strain at the wall",
                  .remedy = "a larger domain helps"}}};
  options::OptionSet options{"sample"};

  Sample() { checks.declare(options); }
  void give(const std::string& limits) {
    options.assign(std::vector<options::Given>{{"check_side_wall", limits, "command line"}});
  }
  io::Summary held(double to_answer, double to_end) const {
    io::Summary summary;
    checks.hold("side_wall", {to_answer, to_end}, summary);
    return summary;
  }
};

TEST(Checks, a_number_within_its_limits_leaves_the_answer_alone) {
  const io::Summary summary = Sample().held(0.2, 0.3);
  EXPECT_EQ(summary.number("check_side_wall"), 0.3);
  EXPECT_TRUE(summary.texts("warnings").empty());
  EXPECT_FALSE(summary.is_withheld());
}

TEST(Checks, a_doubtful_number_warns_in_words) {
  const io::Summary summary = Sample().held(0.2, 0.9);
  EXPECT_FALSE(summary.is_withheld());
  EXPECT_EQ(summary.texts("warnings"),
            std::vector<std::string>{"strain at the wall: 0.9, more than 0.3 (-check_side_wall); "
                                     "a larger domain helps"});
}

TEST(Checks, what_contradicts_the_answer_withholds_it) {
  const io::Summary summary = Sample().held(0.71, 0.9);
  EXPECT_TRUE(summary.is_withheld());
  EXPECT_TRUE(summary.texts("warnings").empty());
  EXPECT_NE(summary.texts("answer_withheld")[0].find("0.71, more than 0.7"), std::string::npos);
}

TEST(Checks, what_is_no_number_is_no_evidence) {
  EXPECT_TRUE(Sample().held(none, 0.1).is_withheld());
  EXPECT_EQ(Sample().held(0.1, none).texts("warnings").size(), 1u);
}

TEST(Checks, limits_are_options) {
  Sample sample;
  sample.give("0.8,0.85");
  EXPECT_TRUE(sample.held(0.75, 0.75).texts("warnings").empty());
  EXPECT_TRUE(sample.held(0.86, 0.86).is_withheld());
}

TEST(Checks, limits_that_do_not_rise_are_refused) {
  for (const char* wrong : {"0.5", "0.7,0.3", "0.1,0.2,0.3", "-1,2"}) {
    Sample sample;
    EXPECT_THROW(sample.give(wrong), BadInput) << wrong;
  }
}

}  // namespace
}  // namespace mpm::run

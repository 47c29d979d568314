#pragma once

#include <string>
#include <vector>

#include "mpm/io/Summary.hpp"
#include "mpm/options/OptionSet.hpp"

namespace mpm::run {

/// A number that a run holds against its own answer: small where the answer is good.
struct Check {
  std::string name;            ///< of the option -check_NAME and of the answer check_NAME
  std::vector<double> limits;  ///< doubtful beyond the first, contradicted beyond the second
  std::string unit = "1";
  std::string sentence;  ///< what the number is
  std::string remedy;    ///< what lowers it
};

/// What was measured: up to the answer, and to the end of the run.
struct Measured {
  double to_answer;
  double to_end;
};

/// The checks of a scene: limits as options, warnings and withheld answers as a summary has them.
class Checks {
 public:
  explicit Checks(std::vector<Check> checks) : m_checks(std::move(checks)) {}

  /// -check_NAME with both limits.
  void declare(options::OptionSet& options);

  /// Puts check_NAME into the summary; warns where a number to the end is beyond its first limit,
  /// or is no number, and withholds the answer where that up to the answer is beyond the second.
  /// Throws std::out_of_range for a name that is not declared.
  void hold(const std::string& name, const Measured& measured, io::Summary& summary) const;

 private:
  std::vector<Check> m_checks;
};

}  // namespace mpm::run

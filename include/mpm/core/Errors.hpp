#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace mpm {

/// What the process returns to the shell; the numbers are part of the interface.
enum class ExitCode : int {
  finished = 0,
  bad_input = 2,
  numerical_failure = 3,
  answer_withheld = 4,  ///< finished, but the run's own checks contradict its answer
  stopped_early = 75
};

/// Input that cannot be run: names the option, the value given, what is allowed and the remedy.
/// Thrown before the first step and identically on all ranks.
class BadInput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Details of a failure that is known by its kind alone: a word for programs, and what to try. Both
/// are plain text without quotes.
inline std::string failure_kind(const std::string& kind, const std::string& remedy) {
  return "{\"kind\":\"" + kind + "\",\"try\":\"" + remedy + "\"}";
}

/// The run cannot go on (NaN, lost particle, collapsed time step, failed write).
/// Thrown on all ranks together, after they have agreed on it.
class NumericalFailure : public std::runtime_error {
 public:
  explicit NumericalFailure(const std::string& message, std::string details = "{}")
      : std::runtime_error(message), m_details(std::move(details)) {}

  /// What is known about the place of the failure, as a JSON object for failure.json.
  const std::string& details() const { return m_details; }

 private:
  std::string m_details;
};

/// The run has been stopped on purpose, with a checkpoint from which it can go on. Thrown on all
/// ranks together.
class StoppedEarly : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace mpm

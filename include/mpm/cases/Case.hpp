#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "mpm/io/Summary.hpp"
#include "mpm/options/OptionSet.hpp"

namespace mpm::cases {

/// A kind of problem: declares its options, builds bodies, walls, rigid bodies and stages from
/// the general parts, and says what its answer is.
class Case {
 public:
  virtual ~Case() = default;
  virtual void declare(options::OptionSet& options) = 0;
  /// Where results go, known once the options are read.
  virtual const std::string& output_directory() const = 0;
  /// Takes the whole input; writes nothing. Throws BadInput where it cannot be run. Collective.
  virtual void prepare() {}
  /// After prepare(): whether results in the output directory are those of this run so far.
  virtual bool goes_on_in_place() const { return false; }
  /// Runs to the end and puts the answers into the summary. Collective.
  virtual void run(io::Summary& summary) = 0;
  /// The answer in one line, after run().
  virtual std::string answer(const io::Summary& summary) const = 0;
};

struct CaseKind {
  std::string_view name;
  std::string_view sentence;
  std::unique_ptr<Case> (*make)();
};

/// The one table of scenes: a new scene is one file and one line here.
std::span<const CaseKind> case_kinds();

}  // namespace mpm::cases

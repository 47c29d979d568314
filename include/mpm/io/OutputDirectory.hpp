#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "mpm/options/Given.hpp"
#include "mpm/petsc/Session.hpp"

namespace mpm::io {

/// The directory that a run writes into, for that run alone as long as this lives; a process that
/// is killed lets go of it. Files that runs have listed there are theirs, all others their user's.
/// Everything is collective over the ranks of the communicator; the first of them does the work.
class OutputDirectory {
 public:
  /// Which file with the name of a result may be there without being listed.
  enum class Unlisted { none, checkpoint };

  /// Makes the directory where it is missing. Throws BadInput, which says why, where it cannot be
  /// made or written, where another run writes into it, and where files of the user have names of
  /// results. Nothing that was there is changed.
  OutputDirectory(options::Given given, Unlisted allowed,
                  const petsc::Communicator& communicator = petsc::world());
  /// Leaves no trace of a run that has not begun.
  ~OutputDirectory();
  OutputDirectory(const OutputDirectory&) = delete;
  OutputDirectory& operator=(const OutputDirectory&) = delete;

  /// Why nothing keeps a second run out, empty where something does. On the first rank.
  const std::string& without_lock() const { return m_without_lock; }

  /// Refuses an option's file that a new run would replace. Throws BadInput.
  void check_input(const options::Given& file) const;
  /// The run begins: what earlier runs have listed goes. Returns how many files that were; throws
  /// BadInput where a checkpoint stands in the way after all.
  std::size_t begin_anew();
  /// The run goes on with what is there, but for its end and what was not whole.
  void go_on();

 private:
  void open();
  void make();
  void hold();
  void check_list() const;
  void check_way(Unlisted allowed) const;
  std::vector<std::string> names_in_the_way(Unlisted allowed) const;
  std::vector<std::string> listed() const;
  bool is_listed(const std::string& name) const;
  bool remove_listed(const std::string& name) const;
  void leave() const;

  template <class Action>
  void on_root(const Action& action) const;
  [[noreturn]] void refuse(const std::string& fault, const std::string& remedy) const;
  [[noreturn]] void refuse_for(int error, const std::filesystem::path& place) const;

  options::Given m_given;
  std::filesystem::path m_path;
  petsc::Communicator m_communicator;
  std::vector<std::filesystem::path> m_made;  ///< directories, parents first
  int m_list = -1;                            ///< the open list, which is the lock as well
  bool m_has_made_list = false;
  bool m_has_begun = false;
  std::string m_without_lock;
};

}  // namespace mpm::io

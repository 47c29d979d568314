#pragma once

#include <memory>
#include <optional>
#include <string>

#include "mpm/core/Archive.hpp"
#include "mpm/run/CheckpointOptions.hpp"
#include "mpm/solver/Simulation.hpp"

namespace mpm::io {
class Hdf5Input;
}

namespace mpm::run {

/// Where a run was when its checkpoint was written, for people.
struct CheckpointMoment {
  long long step = 0;
  double time = 0.0;  ///< s
};

/// Writes all that a run needs to go on: every column of particles and boundary particles in the
/// order in which the ranks have them, who owns which cells, and what `archive` holds. The file
/// before it is lost only once the new one is on the disk. Throws NumericalFailure on all ranks
/// where it cannot be written or ranks disagree on what all should have. Collective.
template <int dim>
void write_checkpoint(const std::string& path, const RunIdentity& identity,
                      const CheckpointMoment& moment, const solver::Simulation<dim>& simulation,
                      const Archive& archive);

/// A checkpoint that is read. Every rank reads for itself; what one cannot read stops all with
/// BadInput, which names file, cause and remedy. All calls are collective.
class Checkpoint {
 public:
  Checkpoint(std::string path, const petsc::Communicator& ranks);
  ~Checkpoint();
  Checkpoint(const Checkpoint&) = delete;
  Checkpoint& operator=(const Checkpoint&) = delete;

  const std::string& path() const { return m_path; }
  const CheckpointMoment& moment() const { return m_moment; }
  /// program_name() of the program that wrote it.
  const std::string& program() const { return m_program; }
  int ranks() const { return m_saved_ranks; }

  /// Throws BadInput unless scene and options are those of the checkpoint, but for those that may
  /// change.
  void check(const RunIdentity& identity) const;

  /// Puts particles and boundary particles back: on the same number of ranks each as it had them;
  /// else equal shares, which then go where they belong.
  template <int dim>
  void put_back(solver::Simulation<dim>& simulation) const;
  /// What was archived, as this rank needs it.
  Archive archive() const;

  /// Throws BadInput: the file named, with what is wrong.
  [[noreturn]] void refuse(const std::string& fault, const std::string& remedy) const;

 private:
  bool is_on_same_ranks() const { return m_saved_ranks == m_ranks.size(); }
  /// Does what may fail on this rank alone.
  template <class Read>
  void on_all(const Read& read) const;
  void read_header();
  template <class Points>
  void put_back_points(const char* group, Points& points) const;
  struct Slab {
    long long first = 0;
    int count = 0;
  };
  Slab slab_of(const char* group) const;
  template <int dim>
  partition::Ownership<dim> ownership() const;
  Archive::Entries read_entries() const;

  std::string m_path;
  petsc::Communicator m_ranks;
  std::unique_ptr<io::Hdf5Input> m_file;
  RunIdentity m_identity;
  CheckpointMoment m_moment;
  std::string m_program;
  int m_saved_ranks = 0;
  int m_dimension = 0;
};

/// The checkpoint that a run with these options goes on from; nothing where it begins anew. Throws
/// BadInput where -restart names none. Collective.
std::optional<std::string> checkpoint_to_go_on_from(const CheckpointOptions& options,
                                                    const std::string& output_dir,
                                                    const petsc::Communicator& ranks);

/// This program: version, commit and the processors it was built for.
std::string program_name();

/// Where a run writes its own.
std::string checkpoint_path(const std::string& output_dir);

}  // namespace mpm::run

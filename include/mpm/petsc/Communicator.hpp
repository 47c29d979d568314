#pragma once

#include <petscsys.h>

#include <span>
#include <string>
#include <vector>

namespace mpm::petsc {

/// The ranks that a grid, its particles and its files are shared by: an MPI_Comm of the caller, who
/// keeps it until all that was built on it is gone. It stands wherever MPI or PETSc asks for one.
/// Everything below rank() and size() is collective over these ranks and knows no others; sums
/// depend on the number of ranks only.
class Communicator {
 public:
  Communicator(MPI_Comm communicator) : m_communicator(communicator) {}
  operator MPI_Comm() const { return m_communicator; }

  int rank() const;
  int size() const;
  bool is_root() const { return rank() == 0; }

  double sum(double value) const;
  double minimum(double value) const;
  double maximum(double value) const;
  long long sum(long long value) const;
  int minimum(int value) const;
  int maximum(int value) const;
  bool all(bool holds) const { return minimum(holds ? 1 : 0) != 0; }
  /// The bits that any rank has set.
  int united_bits(int bits) const;

  /// Of every entry, in place.
  void sum(std::span<double> values) const;
  void minimum(std::span<int> values) const;

  /// Sum over the ranks before this one; 0 on the first.
  long long sum_before(long long value) const;

  /// What one rank has becomes what all have.
  void broadcast(std::vector<int>& values) const;
  void broadcast(std::string& text, int from = 0) const;
  /// The text of the first rank that has one; empty if none has.
  std::string first_text(std::string mine) const;

  void barrier() const;

 private:
  MPI_Comm m_communicator;
};

}  // namespace mpm::petsc

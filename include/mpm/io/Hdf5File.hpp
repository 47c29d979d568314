#pragma once

#include <hdf5.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "mpm/petsc/Communicator.hpp"

namespace mpm::io {

/// What a dataset is. Readers find the rest as its attributes long_name and units.
struct Dataset {
  std::string name;
  std::string long_name;  ///< for people
  std::string unit;       ///< SI, "1" when dimensionless
};

/// Whether a file that has been closed survives the machine, or the program only.
enum class Durability { program, machine };

/// An HDF5 file that the ranks of a communicator write together. It is written as `path.part` and
/// gets its name when closed, so that a file of that name is always whole. All calls are
/// collective; failures throw NumericalFailure on all ranks, which leaves nothing of the new file
/// and the older one as it was.
class Hdf5File {
 public:
  Hdf5File(std::string path, const petsc::Communicator& communicator);
  ~Hdf5File();
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  void attribute(const std::string& name, double value);
  void attribute(const std::string& name, std::int64_t value);

  /// Rows of all ranks one after another: `rows` of `columns` values each from this rank. Groups in
  /// the name are made.
  template <class Value>
  void rows(const Dataset& dataset, std::span<const Value> values, int columns);
  template <class Value>
  void rows(const Dataset& dataset, const std::vector<Value>& values, int columns) {
    rows(dataset, std::span<const Value>(values), columns);
  }
  /// What the first rank has.
  void text(const std::string& name, const std::string& text);

  /// An array of up to three directions, slowest first, of which this rank holds a box.
  struct Block {
    std::vector<hsize_t> global, first, local;
  };
  template <class Value>
  void block(const Dataset& dataset, const std::vector<Value>& values, const Block& block);

  /// Whether HDF5 could not close a file of this process, as under a limit to the size of files: it
  /// would bring the process down when MPI ends. Local.
  static bool has_left_one_open();

  /// Flushes, closes and renames.
  void close(Durability durability = Durability::program);

 private:
  void write(const Dataset& dataset, hid_t type, const void* data, const Block& block);
  void attribute(const std::string& name, hid_t type, const void* value);
  void check(bool ok, const std::string& what) const;
  bool holds(bool ok);
  bool agreed(bool ok);
  void give_up();

  std::string m_path;
  petsc::Communicator m_communicator;
  hid_t m_file = H5I_INVALID_HID;
  std::string m_cause;  ///< of the first fault on this rank
};

}  // namespace mpm::io

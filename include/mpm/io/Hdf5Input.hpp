#pragma once

#include <hdf5.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace mpm::io {

/// An HDF5 file that one rank reads for itself: nothing here is collective. Whatever cannot be read
/// is a std::runtime_error whose text completes "the file ...".
class Hdf5Input {
 public:
  explicit Hdf5Input(const std::string& path);
  ~Hdf5Input() { H5Fclose(m_file); }
  Hdf5Input(const Hdf5Input&) = delete;
  Hdf5Input& operator=(const Hdf5Input&) = delete;

  bool has_attribute(const std::string& name) const;
  std::int64_t attribute(const std::string& name) const;

  /// Entries of a list.
  long long size(const std::string& name) const;
  /// Entries from `first` on, as many as there is room for.
  template <class Value>
  void read(const std::string& name, long long first, std::span<Value> values) const;
  template <class Value>
  std::vector<Value> read_all(const std::string& name) const {
    std::vector<Value> values(static_cast<std::size_t>(size(name)));
    read(name, 0, std::span<Value>(values));
    return values;
  }
  std::string text(const std::string& name) const;

 private:
  hid_t m_file;
};

}  // namespace mpm::io

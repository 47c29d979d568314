#include "mpm/io/Hdf5Input.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "Hdf5Types.hpp"

namespace mpm::io {
namespace {

[[noreturn]] void fail(const std::string& name) {
  throw std::runtime_error(fmt::format("has no '{}' that can be read: it is damaged", name));
}

/// An identifier of HDF5 with what closes it.
class Id {
 public:
  Id(hid_t id, herr_t (*close)(hid_t)) : m_id(id), m_close(close) {}
  ~Id() {
    if (m_id >= 0) m_close(m_id);
  }
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  operator hid_t() const { return m_id; }

 private:
  hid_t m_id;
  herr_t (*m_close)(hid_t);
};

/// Without locks, which some file systems do not have.
hid_t open_file(const std::string& path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // our message replaces HDF5's trace
  const Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_file_locking(access, false, true);
  return H5Fopen(path.c_str(), H5F_ACC_RDONLY, access);
}

}  // namespace

Hdf5Input::Hdf5Input(const std::string& path) : m_file(H5I_INVALID_HID) {
  if (!std::ifstream(path).is_open())
    throw std::runtime_error(fmt::format("cannot be opened: {}", std::strerror(errno)));
  m_file = open_file(path);
  if (m_file < 0) throw std::runtime_error("is no HDF5 file, or has been cut off");
}

bool Hdf5Input::has_attribute(const std::string& name) const {
  return H5Aexists(m_file, name.c_str()) > 0;
}

std::int64_t Hdf5Input::attribute(const std::string& name) const {
  std::int64_t value = 0;
  const Id attribute(H5Aopen(m_file, name.c_str(), H5P_DEFAULT), H5Aclose);
  if (attribute < 0 || H5Aread(attribute, H5T_NATIVE_INT64, &value) < 0) fail(name);
  return value;
}

long long Hdf5Input::size(const std::string& name) const {
  const Id set(H5Dopen2(m_file, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (set < 0) fail(name);
  const Id space(H5Dget_space(set), H5Sclose);
  return H5Sget_simple_extent_npoints(space);
}

template <class Value>
void Hdf5Input::read(const std::string& name, long long first, std::span<Value> values) const {
  if (first + static_cast<long long>(values.size()) > size(name)) fail(name);
  if (values.empty()) return;
  const Id set(H5Dopen2(m_file, name.c_str(), H5P_DEFAULT), H5Dclose);
  const Id file_space(H5Dget_space(set), H5Sclose);
  const auto start = static_cast<hsize_t>(first), count = static_cast<hsize_t>(values.size());
  const Id memory_space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const bool ok =
      H5Sget_simple_extent_ndims(file_space) == 1 &&
      H5Sselect_hyperslab(file_space, H5S_SELECT_SET, &start, nullptr, &count, nullptr) >= 0 &&
      H5Dread(set, native_type<Value>(), memory_space, file_space, H5P_DEFAULT, values.data()) >= 0;
  if (!ok) fail(name);
}

std::string Hdf5Input::text(const std::string& name) const {
  const Id set(H5Dopen2(m_file, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (set < 0) fail(name);
  const Id type(H5Dget_type(set), H5Tclose);
  std::string text(H5Tget_size(type), '\0');
  if (H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) < 0) fail(name);
  return text;
}

template void Hdf5Input::read(const std::string&, long long, std::span<double>) const;
template void Hdf5Input::read(const std::string&, long long, std::span<std::int64_t>) const;
template void Hdf5Input::read(const std::string&, long long, std::span<std::int32_t>) const;

}  // namespace mpm::io

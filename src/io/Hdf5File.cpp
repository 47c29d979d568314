#include "mpm/io/Hdf5File.hpp"

#include <fmt/format.h>
#include <mpi.h>
#include <petscsys.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "mpm/core/Errors.hpp"
#include "mpm/io/ResultFiles.hpp"

namespace mpm::io {
namespace {

template <class Value>
hid_t native_type();
template <>
hid_t native_type<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
hid_t native_type<float>() {
  return H5T_NATIVE_FLOAT;
}
template <>
hid_t native_type<std::int64_t>() {
  return H5T_NATIVE_INT64;
}
template <>
hid_t native_type<std::int32_t>() {
  return H5T_NATIVE_INT32;
}

hsize_t product(const std::vector<hsize_t>& factors) {
  hsize_t result = 1;
  for (hsize_t factor : factors) result *= factor;
  return result;
}

/// An attribute of a file or a dataset; tells whether it was written.
bool write_attribute(hid_t object, const std::string& name, hid_t type, const void* value) {
  const hid_t space = H5Screate(H5S_SCALAR);
  const hid_t id = H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT);
  const bool ok = id >= 0 && H5Awrite(id, type, value) >= 0;
  if (id >= 0) H5Aclose(id);
  H5Sclose(space);
  return ok;
}

bool write_text_attribute(hid_t object, const std::string& name, const std::string& text) {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, text.size());
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, H5T_CSET_UTF8);
  const bool ok = write_attribute(object, name, type, text.data());
  H5Tclose(type);
  return ok;
}

}  // namespace

/// Agrees over all ranks, so that none waits for another that has given up.
void Hdf5File::check(bool ok, const std::string& what) const {
  if (!m_communicator.all(ok))
    throw NumericalFailure(fmt::format(
        "cannot {} '{}': check that the directory exists, can be written and is not full", what,
        m_path));
}

Hdf5File::Hdf5File(std::string path, const petsc::Communicator& communicator)
    : m_path(std::move(path)), m_communicator(communicator) {
  check(!m_communicator.is_root() || register_result(m_path), "list");
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // our message replaces HDF5's trace
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fapl_mpio(access, m_communicator, MPI_INFO_NULL);
  m_file = H5Fcreate((m_path + ".part").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
  H5Pclose(access);
  check(m_file >= 0, "create");
}

Hdf5File::~Hdf5File() {
  if (m_file >= 0) H5Fclose(m_file);
}

void Hdf5File::attribute(const std::string& name, hid_t type, const void* value) {
  check(write_attribute(m_file, name, type, value), "write attribute " + name + " to");
}

void Hdf5File::attribute(const std::string& name, double value) {
  attribute(name, H5T_NATIVE_DOUBLE, &value);
}

void Hdf5File::attribute(const std::string& name, std::int64_t value) {
  attribute(name, H5T_NATIVE_INT64, &value);
}

void Hdf5File::write(const Dataset& dataset, hid_t type, const void* data, const Block& block) {
  const auto rank = static_cast<int>(block.global.size());
  const hid_t file_space = H5Screate_simple(rank, block.global.data(), nullptr);
  const hid_t memory_space = H5Screate_simple(rank, block.local.data(), nullptr);
  if (product(block.local) == 0) {
    H5Sselect_none(file_space);
    H5Sselect_none(memory_space);
  } else {
    H5Sselect_hyperslab(file_space, H5S_SELECT_SET, block.first.data(), nullptr, block.local.data(),
                        nullptr);
  }
  const hid_t set = H5Dcreate2(m_file, dataset.name.c_str(), type, file_space, H5P_DEFAULT,
                               H5P_DEFAULT, H5P_DEFAULT);
  const hid_t transfer = H5Pcreate(H5P_DATASET_XFER);
  H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE);
  const bool ok = set >= 0 && H5Dwrite(set, type, memory_space, file_space, transfer, data) >= 0 &&
                  write_text_attribute(set, "long_name", dataset.long_name) &&
                  write_text_attribute(set, "units", dataset.unit);
  H5Pclose(transfer);
  if (set >= 0) H5Dclose(set);
  H5Sclose(memory_space);
  H5Sclose(file_space);
  check(ok, "write " + dataset.name + " to");
}

template <class Value>
void Hdf5File::block(const Dataset& dataset, const std::vector<Value>& values, const Block& block) {
  write(dataset, native_type<Value>(), values.data(), block);
}

template <class Value>
void Hdf5File::rows(const Dataset& dataset, const std::vector<Value>& values, int columns) {
  const auto width = static_cast<hsize_t>(columns);
  const auto local = static_cast<long long>(values.size() / width);
  Block block{{static_cast<hsize_t>(m_communicator.sum(local))},
              {static_cast<hsize_t>(m_communicator.sum_before(local))},
              {static_cast<hsize_t>(local)}};
  if (columns > 1) {
    block.global.push_back(width);
    block.first.push_back(0);
    block.local.push_back(width);
  }
  write(dataset, native_type<Value>(), values.data(), block);
}

void Hdf5File::close() {
  const bool closed = H5Fclose(std::exchange(m_file, H5I_INVALID_HID)) >= 0;
  check(closed, "close");
  check(!m_communicator.is_root() || std::rename((m_path + ".part").c_str(), m_path.c_str()) == 0,
        "rename");
}

template void Hdf5File::rows(const Dataset&, const std::vector<double>&, int);
template void Hdf5File::rows(const Dataset&, const std::vector<float>&, int);
template void Hdf5File::rows(const Dataset&, const std::vector<std::int64_t>&, int);
template void Hdf5File::rows(const Dataset&, const std::vector<std::int32_t>&, int);
template void Hdf5File::block(const Dataset&, const std::vector<double>&, const Block&);

}  // namespace mpm::io

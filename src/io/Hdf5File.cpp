#include "mpm/io/Hdf5File.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <mpi.h>
#include <petscsys.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "Hdf5Types.hpp"
#include "mpm/core/Errors.hpp"
#include "mpm/io/ResultFiles.hpp"

namespace mpm::io {
namespace {

hsize_t product(const std::vector<hsize_t>& factors) {
  hsize_t result = 1;
  for (hsize_t factor : factors) result *= factor;
  return result;
}

/// Free on the disk of a file, which writing may have filled.
std::string room_for(const std::string& path) {
  const auto directory = std::filesystem::path(path).parent_path();
  std::error_code fault;
  const auto room = std::filesystem::space(directory.empty() ? "." : directory, fault);
  return fault ? fault.message() : fmt::format("{} bytes are free there", room.available);
}

constexpr std::size_t probe = 1 << 20;  // bytes, more than what is left of a block

/// Why a file cannot grow: MPI's files take a write that the disk cuts short for a fault of their
/// own, and the system has no word for it before the next one. 0 if it can.
int fault_of_next_write(const std::string& path) {
  const int file = open(path.c_str(), O_WRONLY | O_APPEND);
  if (file < 0) return errno;
  const std::vector<char> zeros(probe);
  ssize_t written = 0;
  for (std::size_t all = 0; all < probe && written >= 0; all += static_cast<std::size_t>(written))
    written = ::write(file, zeros.data(), probe - all);
  const int number = written < 0 ? errno : 0;
  ::close(file);
  return number;
}

bool is_one_left_open = false;

/// From now on this process writes a file that has failed into memory instead, so that HDF5 can
/// close it.
void send_to_memory(const std::string& path) {
  std::error_code fault;
  const auto wanted = std::filesystem::absolute(path, fault);
  const int memory = memfd_create("given_up", 0);
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", fault)) {
    std::error_code gone;  // the listing's own descriptor
    const auto target = std::filesystem::read_symlink(entry.path(), gone);
    if (memory >= 0 && !gone && std::filesystem::weakly_canonical(wanted, gone) == target)
      dup2(memory, std::stoi(entry.path().filename().string()));
  }
  if (memory >= 0) ::close(memory);
}

/// What went wrong where HDF5 noticed first, and what the system says.
std::string cause_of_fault(const std::string& path) {
  const int number = errno != 0 ? errno : fault_of_next_write(path + ".part");
  std::string cause;
  const auto visit = [](unsigned, const H5E_error2_t* error, void* text) -> herr_t {
    auto& first = *static_cast<std::string*>(text);
    if (first.empty() && error->desc != nullptr) first = error->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, visit, &cause);
  if (number != 0) cause += fmt::format("{}{}", cause.empty() ? "" : "; ", std::strerror(number));
  return fmt::format("{}{}{}", cause, cause.empty() ? "" : "; ", room_for(path));
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

hid_t text_type(std::size_t size) {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, std::max<std::size_t>(1, size));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

bool write_text_attribute(hid_t object, const std::string& name, const std::string& text) {
  const hid_t type = text_type(text.size());
  const bool ok = write_attribute(object, name, type, text.data());
  H5Tclose(type);
  return ok;
}

/// Brings what has been written to a file or a directory to the disk.
bool synchronise(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY);
  if (file < 0) return false;
  const bool ok = fsync(file) == 0;
  return close(file) == 0 && ok;
}

bool rename_for_good(const std::string& from, const std::string& to, Durability durability) {
  const bool is_durable = durability == Durability::machine;
  if (is_durable && !synchronise(from)) return false;
  if (std::rename(from.c_str(), to.c_str()) != 0) return false;
  const std::string directory = std::filesystem::path(to).parent_path().string();
  return !is_durable || synchronise(directory.empty() ? "." : directory);
}

}  // namespace

/// Keeps the cause of a fault before another call of HDF5 forgets it.
bool Hdf5File::holds(bool ok) {
  if (!ok && m_cause.empty()) m_cause = cause_of_fault(m_path);
  return ok;
}

bool Hdf5File::agreed(bool ok) {
  return m_communicator.all(holds(ok));
}

/// Agrees over all ranks, so that none waits for another that has given up.
void Hdf5File::check(bool ok, const std::string& what) const {
  if (m_communicator.all(ok)) return;
  const std::string cause = m_communicator.first_text(ok ? "" : m_cause);
  throw NumericalFailure(
      fmt::format("cannot {} '{}' ({}): check that the directory exists, can be written and is not "
                  "full",
                  what, m_path, cause.empty() ? std::strerror(errno) : cause),
      failure_kind("cannot_write", "a directory that can be written and is not full"));
}

Hdf5File::Hdf5File(std::string path, const petsc::Communicator& communicator)
    : m_path(std::move(path)), m_communicator(communicator) {
  check(!m_communicator.is_root() || register_result(m_path), "list");
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // our message replaces HDF5's trace
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fapl_mpio(access, m_communicator, MPI_INFO_NULL);
  errno = 0;
  m_file = H5Fcreate((m_path + ".part").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
  const bool ok = holds(m_file >= 0);
  H5Pclose(access);
  check(ok, "create");
}

Hdf5File::~Hdf5File() {
  if (m_file >= 0) give_up();
}

void Hdf5File::give_up() {
  send_to_memory(m_path + ".part");
  if (H5Fclose(std::exchange(m_file, H5I_INVALID_HID)) < 0) is_one_left_open = true;
  if (m_communicator.is_root()) std::remove((m_path + ".part").c_str());
}

bool Hdf5File::has_left_one_open() {
  return is_one_left_open;
}

void Hdf5File::attribute(const std::string& name, hid_t type, const void* value) {
  check(holds(write_attribute(m_file, name, type, value)), "write attribute " + name + " to");
}

void Hdf5File::attribute(const std::string& name, double value) {
  attribute(name, H5T_NATIVE_DOUBLE, &value);
}

void Hdf5File::attribute(const std::string& name, std::int64_t value) {
  attribute(name, H5T_NATIVE_INT64, &value);
}

void Hdf5File::text(const std::string& name, const std::string& text) {
  std::string common = text;
  m_communicator.broadcast(common);  // of one length
  const hid_t type = text_type(common.size());
  const hsize_t mine = m_communicator.is_root() ? 1 : 0;
  write({name, "text", "1"}, type, common.data(), {{1}, {0}, {mine}});
  H5Tclose(type);
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
  const hid_t links = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(links, 1);
  const hid_t transfer = H5Pcreate(H5P_DATASET_XFER);
  H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE);
  errno = 0;
  const hid_t set =
      H5Dcreate2(m_file, dataset.name.c_str(), type, file_space, links, H5P_DEFAULT, H5P_DEFAULT);
  const auto written = [&] {  // an empty dataset has no place in the file
    return product(block.global) == 0 ||
           H5Dwrite(set, type, memory_space, file_space, transfer, data) >= 0;
  };
  // Each of these is taken by all ranks or by none: one alone would wait for the others for ever.
  const bool ok = agreed(set >= 0) && agreed(written()) &&
                  agreed(write_text_attribute(set, "long_name", dataset.long_name) &&
                         write_text_attribute(set, "units", dataset.unit));
  H5Pclose(transfer);
  H5Pclose(links);
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
void Hdf5File::rows(const Dataset& dataset, std::span<const Value> values, int columns) {
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

void Hdf5File::close(Durability durability) {
  errno = 0;
  check(holds(H5Fflush(m_file, H5F_SCOPE_GLOBAL) >= 0), "flush");
  const bool closed = holds(H5Fclose(std::exchange(m_file, H5I_INVALID_HID)) >= 0);
  if (!closed) is_one_left_open = true;
  check(closed, "close");
  const std::string part = m_path + ".part";
  const bool renamed =
      holds(!m_communicator.is_root() || rename_for_good(part, m_path, durability));
  if (!renamed) std::remove(part.c_str());
  check(renamed, "rename");
}

template void Hdf5File::rows(const Dataset&, std::span<const double>, int);
template void Hdf5File::rows(const Dataset&, std::span<const float>, int);
template void Hdf5File::rows(const Dataset&, std::span<const std::int64_t>, int);
template void Hdf5File::rows(const Dataset&, std::span<const std::int32_t>, int);
template void Hdf5File::block(const Dataset&, const std::vector<double>&, const Block&);

}  // namespace mpm::io

#include "mpm/petsc/Communicator.hpp"

namespace mpm::petsc {
namespace {

template <class Number>
Number reduce(MPI_Comm communicator, Number value, MPI_Datatype type, MPI_Op operation) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, type, operation, communicator);
  return value;
}

/// A vector or a string, whose length the others need not know.
template <class Values>
void broadcast_all(MPI_Comm communicator, Values& values, MPI_Datatype type, int from) {
  auto size = static_cast<int>(values.size());
  MPI_Bcast(&size, 1, MPI_INT, from, communicator);
  values.resize(static_cast<std::size_t>(size));
  MPI_Bcast(values.data(), size, type, from, communicator);
}

}  // namespace

int Communicator::rank() const {
  int rank = 0;
  MPI_Comm_rank(m_communicator, &rank);
  return rank;
}

int Communicator::size() const {
  int size = 1;
  MPI_Comm_size(m_communicator, &size);
  return size;
}

double Communicator::sum(double value) const {
  return reduce(m_communicator, value, MPI_DOUBLE, MPI_SUM);
}
double Communicator::minimum(double value) const {
  return reduce(m_communicator, value, MPI_DOUBLE, MPI_MIN);
}
double Communicator::maximum(double value) const {
  return reduce(m_communicator, value, MPI_DOUBLE, MPI_MAX);
}
long long Communicator::sum(long long value) const {
  return reduce(m_communicator, value, MPI_LONG_LONG, MPI_SUM);
}
int Communicator::minimum(int value) const {
  return reduce(m_communicator, value, MPI_INT, MPI_MIN);
}
int Communicator::maximum(int value) const {
  return reduce(m_communicator, value, MPI_INT, MPI_MAX);
}

int Communicator::united_bits(int bits) const {
  return reduce(m_communicator, bits, MPI_INT, MPI_BOR);
}

void Communicator::sum(std::span<double> values) const {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM,
                m_communicator);
}

void Communicator::minimum(std::span<int> values) const {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_INT, MPI_MIN,
                m_communicator);
}

long long Communicator::sum_before(long long value) const {
  long long sum = 0;  // MPI leaves it alone on the first rank
  MPI_Exscan(&value, &sum, 1, MPI_LONG_LONG, MPI_SUM, m_communicator);
  return rank() == 0 ? 0 : sum;
}

void Communicator::broadcast(std::vector<int>& values) const {
  broadcast_all(m_communicator, values, MPI_INT, 0);
}
void Communicator::broadcast(std::string& text, int from) const {
  broadcast_all(m_communicator, text, MPI_CHAR, from);
}

std::string Communicator::first_text(std::string mine) const {
  const int first = minimum(mine.empty() ? size() : rank());
  if (first == size()) return "";
  broadcast(mine, first);
  return mine;
}

void Communicator::barrier() const {
  MPI_Barrier(m_communicator);
}

}  // namespace mpm::petsc

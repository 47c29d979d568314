#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace mpm::grid {

/// Half-open box of node or cell indices.
template <int dim>
struct Box {
  std::array<int, dim> begin{};
  std::array<int, dim> end{};

  bool contains(const std::array<int, dim>& index) const {
    for (int d = 0; d < dim; ++d)
      if (index[d] < begin[d] || index[d] >= end[d]) return false;
    return true;
  }
  bool operator==(const Box&) const = default;
  int extent(int d) const { return end[d] - begin[d]; }
  int size() const {
    int product = 1;
    for (int d = 0; d < dim; ++d) product *= extent(d);
    return product;
  }
  /// Position in an array over the box, first direction fastest.
  int index_of(const std::array<int, dim>& index) const {
    int position = 0;
    for (int d = dim - 1; d >= 0; --d) position = position * extent(d) + index[d] - begin[d];
    return position;
  }
  /// Index distance in such an array between neighbours in direction d.
  std::ptrdiff_t stride(int d) const {
    std::ptrdiff_t product = 1;
    for (int k = 0; k < d; ++k) product *= extent(k);
    return product;
  }
  /// visit(position, index) in the order of such an array.
  template <class Visit>
  void for_each(const Visit& visit) const {
    std::array<int, dim> index = begin;
    for (int position = 0; position < size(); ++position) {
      visit(position, index);
      int d = 0;
      while (d < dim - 1 && index[d] + 1 == end[d]) index[d] = begin[d], ++d;
      ++index[d];
    }
  }
};

/// What two boxes share; empty in a direction where they share nothing.
template <int dim>
Box<dim> intersection(const Box<dim>& a, const Box<dim>& b) {
  Box<dim> box;
  for (int d = 0; d < dim; ++d) {
    box.begin[d] = std::max(a.begin[d], b.begin[d]);
    box.end[d] = std::max(box.begin[d], std::min(a.end[d], b.end[d]));
  }
  return box;
}

using Marks = std::vector<unsigned char>;

/// The cells of a box, or those of them that have a mark.
template <int dim>
class CellSet {
 public:
  CellSet(const Box<dim>& box) : m_box(box) {}
  /// Cells whose mark has this bit. `marks` are those of all cells of `frame`, which holds `box`,
  /// and must outlive the set.
  CellSet(const Box<dim>& box, const Box<dim>& frame, const Marks& marks, unsigned char bit)
      : m_box(box), m_frame(frame), m_marks(marks.data()), m_bit(bit) {}

  bool contains(const std::array<int, dim>& cell) const {
    return m_box.contains(cell) &&
           (m_marks == nullptr || (m_marks[m_frame.index_of(cell)] & m_bit) != 0);
  }
  /// A box around all of them.
  const Box<dim>& box() const { return m_box; }
  /// visit(cell), first direction fastest.
  template <class Visit>
  void for_each(const Visit& visit) const {
    m_box.for_each([&](int, const std::array<int, dim>& cell) {
      if (contains(cell)) visit(cell);
    });
  }

 private:
  Box<dim> m_box, m_frame;
  const unsigned char* m_marks = nullptr;  ///< null: all cells of the box
  unsigned char m_bit = 0;
};

/// Nodes that follow each other along the first direction, and so in the local arrays.
template <int dim>
struct Run {
  int first;  ///< position in the local arrays
  int count;
  std::array<int, dim> node;  ///< the first one
};

}  // namespace mpm::grid

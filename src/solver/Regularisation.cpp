#include "mpm/solver/Regularisation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "mpm/core/Errors.hpp"
#include "mpm/petsc/Log.hpp"

namespace mpm::solver {
namespace {

constexpr int fewest_cells = 3;  // of cubic splines

/// Equal cells that hold all of `inside`, also where rounding would leave its ends out.
basis::KnotLines lines_around(const basis::KnotLines& inside, double begin, double end, int cells) {
  std::vector<double> positions = basis::KnotLines::uniform(begin, end, cells).positions();
  positions.front() = std::min(positions.front(), inside.begin());
  positions.back() = std::max(positions.back(), inside.end());
  return basis::KnotLines(std::move(positions));
}

int cells_over(double length, double L) {
  return std::max(fewest_cells, static_cast<int>(std::ceil(length / L - 1e-9)));
}

/// The whole body of a half that ends in the middle has the same lines: an even number of cells.
basis::KnotLines lines_between_walls(const basis::KnotLines& lines,
                                     const std::array<grid::Wall, 2>& walls, double L) {
  const double length = lines.end() - lines.begin();
  const int multiple = std::ranges::count(walls, grid::Wall::symmetry) > 0 ? 1 : 2;
  const int cells = multiple * static_cast<int>(std::round(length / (multiple * L)));
  if (cells < fewest_cells)
    throw BadInput(fmt::format(
        "-regularisation_length {} m: the walls are {:.6g} m apart; at most {:.4g} m is allowed, "
        "which leaves room for averaging between them: a shorter length or a larger domain",
        L, length, length / (multiple + 2)));
  return lines_around(lines, lines.begin(), lines.end(), cells);
}

void check_length(const basis::KnotLines& lines, double L) {
  constexpr double fewest = 2.0;  // cells in a length
  const double h = lines.smallest_width();
  if (L < fewest * h * (1.0 - 1e-9))
    throw BadInput(fmt::format(
        "-regularisation_length {} m: with cells of {:.6g} m it has to be at least {:.6g} m, since "
        "a shorter one regularises nothing, or 0: a longer length or smaller cells",
        L, h, fewest * h));
}

}  // namespace

basis::KnotLines averaging_lines(const basis::KnotLines& lines,
                                 const std::array<grid::Wall, 2>& walls, double L) {
  check_length(lines, L);
  const double length = lines.end() - lines.begin();
  const bool first = walls[0] != grid::Wall::free, last = walls[1] != grid::Wall::free;
  if (first && last) return lines_between_walls(lines, walls, L);
  const int cells = cells_over(length, L);
  if (first) return lines_around(lines, lines.begin(), lines.begin() + L * cells, cells);
  if (last) return lines_around(lines, lines.end() - L * cells, lines.end(), cells);
  const int half = cells_over(0.5 * length, L);
  const double middle = 0.5 * (lines.begin() + lines.end());
  return lines_around(lines, middle - L * half, middle + L * half, 2 * half);
}

namespace {

template <int dim>
std::array<basis::BSpline<3>, dim> averaging_bases(const std::array<basis::KnotLines, dim>& lines,
                                                   const typename grid::Walls<dim>::Kinds& walls,
                                                   double L) {
  return [&]<std::size_t... d>(std::index_sequence<d...>) {
    return std::array<basis::BSpline<3>, dim>{
        basis::BSpline<3>(averaging_lines(lines[d], walls[d], L), basis::EndTreatment::mirror)...};
  }
  (std::make_index_sequence<static_cast<std::size_t>(dim)>{});
}

/// All of it on this rank.
template <int dim>
std::unique_ptr<grid::Grid<dim>> own_grid(const std::array<basis::BSpline<3>, dim>& bases) {
  partition::Layout<dim> layout;
  for (int d = 0; d < dim; ++d) layout.starts[d] = {0, bases[d].count()};
  return [&]<std::size_t... d>(std::index_sequence<d...>) {
    return std::make_unique<grid::Grid<dim>>(
        PETSC_COMM_SELF, std::array<basis::NodeLine, dim>{bases[d].nodes()...}, layout);
  }
  (std::make_index_sequence<static_cast<std::size_t>(dim)>{});
}

}  // namespace

template <int dim>
Regularisation<dim>::Regularisation(const RegularisationOptions& options,
                                    const std::array<basis::KnotLines, dim>& lines,
                                    const typename grid::Walls<dim>::Kinds& walls,
                                    particles::Particles<dim>& particles)
    : m_every(options.every),
      m_particles(particles),
      m_softening(find_softening(options.length)),
      m_bases(averaging_bases<dim>(lines, walls, options.length)),
      m_grid(own_grid<dim>(m_bases)),
      m_walls(walls) {
  m_sums = std::make_unique<grid::NodalField<dim>>(
      *m_grid, std::vector<grid::Component>(2 * m_names.size(), {grid::Component::scalar}));
}

template <int dim>
auto Regularisation<dim>::find_softening(double L) -> std::vector<std::vector<Softening>> {
  std::vector<std::vector<Softening>> softening;
  for (std::size_t k = 0; k < m_particles.materials().size(); ++k)
    softening.push_back(softening_of(static_cast<int>(k)));
  if (m_names.empty())
    throw BadInput(fmt::format(
        "-regularisation_length {} m: no law of this run softens by its state, there is nothing "
        "to average; 0 is allowed, or a law that does, such as sand",
        L));
  return softening;
}

template <int dim>
auto Regularisation<dim>::softening_of(int material) -> std::vector<Softening> {
  std::vector<Softening> softening;
  const auto& law = *m_particles.materials()[static_cast<std::size_t>(material)];
  for (const material::StateVariable& variable : law.state_variables()) {
    if (variable.role != material::StateRole::softening) continue;
    const auto found = std::ranges::find(m_names, variable.name);
    const auto number = static_cast<int>(found - m_names.begin());
    if (found == m_names.end()) m_names.push_back(variable.name);
    softening.push_back(
        {m_particles.state(material, variable.name),
         m_particles.fields().handle(particles::name_before_averaging(variable.name)), number});
  }
  return softening;
}

/// visit(material, range of its particles) for the laws that soften.
template <int dim>
template <class Visit>
void Regularisation<dim>::for_each_material(const Visit& visit) const {
  for (std::size_t k = 0; k < m_softening.size(); ++k)
    if (!m_softening[k].empty())
      visit(static_cast<int>(k), m_particles.range_of(static_cast<int>(k)));
}

template <int dim>
void Regularisation<dim>::begin_step() {
  if (m_steps > 0) return;
  const particles::ParticleView<dim> view = m_particles.view();
  for_each_material([&](int material, const particles::Range& range) {
    for (const Softening& variable : m_softening[static_cast<std::size_t>(material)])
      std::copy(view[variable.now] + range.first, view[variable.now] + range.last,
                view[variable.before] + range.first);
  });
}

template <int dim>
void Regularisation<dim>::end_step() {
  if (++m_steps < m_every) return;
  const petsc::Phase phase("mpm: regularise");
  average(m_particles.view());
  m_steps = 0;
}

template <int dim>
std::vector<transfer::AveragedState> Regularisation<dim>::states(
    const particles::ParticleView<dim>& view, int material) {
  std::vector<transfer::AveragedState> states;
  for (const Softening& variable : m_softening[static_cast<std::size_t>(material)])
    states.push_back({view[variable.now], view[variable.before],
                      m_sums->values(2 * variable.number),
                      m_sums->values(2 * variable.number + 1)});
  return states;
}

template <int dim>
void Regularisation<dim>::average(const particles::ParticleView<dim>& view) {
  const transfer::Stencil<dim, basis::BSpline<3>> stencil(*m_grid, m_bases);
  m_sums->set_to_zero();
  for_each_material([&](int material, const particles::Range& range) {
    transfer::deposit_state_increments<dim>(view, range, stencil, states(view, material));
  });
  const auto size = static_cast<std::size_t>(m_grid->local_size());
  m_particles.communicator().sum(std::span(m_sums->values(0), 2 * m_names.size() * size));
  m_walls.fold(*m_grid, *m_sums);
  for (int k = 0; k < m_sums->components(); k += 2) {
    const double* const volume = m_sums->values(k);
    double* const increment = m_sums->values(k + 1);
    for (std::size_t I = 0; I < size; ++I)
      if (volume[I] > 0.0) increment[I] /= volume[I];
  }
  m_walls.unfold(*m_grid, *m_sums);
  for_each_material([&](int material, const particles::Range& range) {
    transfer::take_averaged_increments<dim>(view, range, stencil, states(view, material));
  });
}

template class Regularisation<1>;
template class Regularisation<2>;
template class Regularisation<3>;

}  // namespace mpm::solver

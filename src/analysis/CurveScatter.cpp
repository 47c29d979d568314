#include "mpm/analysis/CurveScatter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace mpm::analysis {
namespace {

using Columns = std::vector<std::vector<double>>;

/// Of fewer teeth it cannot be told whether they come again.
constexpr double fewest_teeth = 4.0;
constexpr int harmonics = 3;  ///< of the saw-teeth
constexpr double longest_memory = 0.9;
constexpr double memory_spacing = 0.05;
constexpr double scale_reach = 0.07;     ///< in u/D, of the mean that scatter is relative to
constexpr double fewest_freedoms = 5.0;  ///< steps less coefficients
/// Distances in u/D between the knots of the smooth curve, of which one is chosen.
constexpr std::array bends = {0.15, 0.1, 0.075, 0.05};
/// Below this share of the largest N_d the curve bends too sharply for its scatter to be judged.
constexpr double judged_from = 0.25;

/// Mean over up to `reach` steps to either side, as many to one as to the other.
double local_mean(std::span<const double> values, std::size_t k, std::size_t reach) {
  const std::size_t side = std::min({k, values.size() - 1 - k, reach});
  double sum = 0.0;
  for (std::size_t i = k - side; i <= k + side; ++i) sum += values[i];
  return sum / static_cast<double>(2 * side + 1);
}

/// Uniform in (0, 1): the standard leaves distributions to the library, so they are made here.
double uniform(std::mt19937_64& engine) {
  return (static_cast<double>(engine() >> 11) + 0.5) * 0x1.0p-53;
}

/// Box and Muller (1958).
double normal(std::mt19937_64& engine) {
  const double radius = std::sqrt(-2.0 * std::log(uniform(engine)));
  return radius * std::cos(2.0 * std::numbers::pi * uniform(engine));
}

double chi_squared(double freedom, std::mt19937_64& engine) {
  double sum = 0.0;
  for (int k = 0; k < static_cast<int>(freedom); ++k) sum += std::pow(normal(engine), 2);
  return sum;
}

/// Cubic B-spline on the knots -2 to 2.
double bump(double t) {
  const double a = std::abs(t);
  if (a >= 2.0) return 0.0;
  if (a >= 1.0) return std::pow(2.0 - a, 3) / 6.0;
  return 2.0 / 3.0 - a * a + 0.5 * a * a * a;
}

/// Cubic splines with knots about `bend` steps apart, each times the carrier.
void add_spline(Columns& columns, const std::vector<double>& carrier, double bend) {
  const std::size_t rows = carrier.size();
  const double length = static_cast<double>(rows - 1);
  const int spans = std::max(1, static_cast<int>(std::lround(length / bend)));
  for (int j = -1; j <= spans + 1; ++j) {
    auto& column = columns.emplace_back(rows);
    for (std::size_t k = 0; k < rows; ++k) {
      column[k] = carrier[k] * bump(static_cast<double>(k) * spans / length - j);
    }
  }
}

/// Sine and cosine of each harmonic of the teeth over steps `first` and on; none without a period.
Columns waves(std::size_t first, std::size_t rows, double steps_per_period) {
  if (steps_per_period <= 0.0) return {};
  Columns columns(2 * harmonics, std::vector<double>(rows));
  for (std::size_t j = 0; j < columns.size(); ++j) {
    const double per_step =
        2.0 * std::numbers::pi * static_cast<double>(j / 2 + 1) / steps_per_period;
    for (std::size_t k = 0; k < rows; ++k) {
      const double angle = per_step * static_cast<double>(first + k);
      columns[j][k] = j % 2 == 0 ? std::sin(angle) : std::cos(angle);
    }
  }
  return columns;
}

/// Lower Cholesky factor in place of a positive definite matrix; the small addition keeps columns
/// that a short curve cannot tell apart from stopping it.
void factorize(Columns& matrix) {
  const std::size_t size = matrix.size();
  for (std::size_t i = 0; i < size; ++i) matrix[i][i] *= 1.0 + 1e-10;
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = matrix[i][j];
      for (std::size_t k = 0; k < j; ++k) sum -= matrix[i][k] * matrix[j][k];
      matrix[i][j] = i == j ? std::sqrt(std::max(sum, 1e-300)) : sum / matrix[j][j];
    }
  }
}

/// Solves L L^T x = b.
std::vector<double> solve(const Columns& L, std::vector<double> b) {
  const std::size_t size = b.size();
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= L[i][k] * b[k];
    b[i] /= L[i][i];
  }
  for (std::size_t i = size; i-- > 0;) {
    for (std::size_t k = i + 1; k < size; ++k) b[i] -= L[k][i] * b[k];
    b[i] /= L[i][i];
  }
  return b;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

/// Takes the memory out of a series, so that its entries are independent.
std::vector<double> whitened(const std::vector<double>& series, double phi) {
  std::vector<double> result(series);
  for (std::size_t k = 1; k < series.size(); ++k) result[k] -= phi * series[k - 1];
  result[0] *= std::sqrt(1.0 - phi * phi);
  return result;
}

/// Least squares of the relative curve on some columns when a memory has been taken out.
struct Regression {
  CurveScatter::Memory memory;
  std::vector<double> coefficients;
  std::vector<double> variances;  ///< of the coefficients
};

/// Inner products of the columns with each other and with the target.
void normal_equations(const Columns& columns, const std::vector<double>& target, Columns& matrix,
                      std::vector<double>& right) {
  for (const auto& column : columns) {
    auto& row = matrix.emplace_back();
    for (const auto& other : columns) row.push_back(dot(column, other));
    right.push_back(dot(column, target));
  }
}

Regression regress(const Columns& columns, const std::vector<double>& relative, double phi) {
  Columns white, factor;
  for (const auto& column : columns) white.push_back(whitened(column, phi));
  const std::vector<double> target = whitened(relative, phi);
  std::vector<double> right;
  normal_equations(white, target, factor, right);
  factorize(factor);

  Regression result{.memory = {.phi = phi}, .coefficients = solve(factor, right)};
  const double freedom = static_cast<double>(target.size()) - static_cast<double>(columns.size());
  const double all = dot(target, target);
  auto& [_, likelihood, squares] = result.memory;
  squares = std::max(all - dot(result.coefficients, right), 1e-14 * all);
  likelihood = 0.5 * (std::log(1.0 - phi * phi) - freedom * std::log(squares));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    std::vector<double> unit(columns.size(), 0.0);
    unit[i] = 1.0;
    likelihood -= std::log(factor[i][i]);
    result.variances.push_back(solve(factor, unit)[i] * squares / freedom);
  }
  return result;
}

/// One for each memory; none for too few rows.
std::vector<Regression> regressions(const Columns& columns, const std::vector<double>& relative) {
  std::vector<Regression> result;
  const auto rows = static_cast<double>(relative.size());
  if (rows - static_cast<double>(columns.size()) < fewest_freedoms) return result;
  for (int k = 0; k * memory_spacing <= longest_memory + 1e-9; ++k) {
    result.push_back(regress(columns, relative, k * memory_spacing));
  }
  return result;
}

const Regression& likeliest(const std::vector<Regression>& all) {
  return *std::max_element(all.begin(), all.end(), [](const Regression& a, const Regression& b) {
    return a.memory.likelihood < b.memory.likelihood;
  });
}

/// Akaike's criterion, 2 p - 2 log L, of p columns with the memory that suits them best.
double criterion(const std::vector<Regression>& all, double rows) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const auto& [memory, coefficients, _] : all) {
    const double misfit = rows * std::log(memory.squares) - std::log(1.0 - std::pow(memory.phi, 2));
    lowest = std::min(lowest, misfit + 2.0 * static_cast<double>(coefficients.size()));
  }
  return lowest;
}

}  // namespace

CurveScatter::CurveScatter(std::span<const double> N_d, std::span<const double> shape, double step,
                           double tooth_period)
    : m_resistance(N_d.begin(), N_d.end()) {
  const double lowest = judged_from * *std::max_element(N_d.begin(), N_d.end());
  while (N_d[m_first] < lowest) ++m_first;
  const auto reach = static_cast<std::size_t>(std::lround(scale_reach / step));
  for (std::size_t k = 0; k < N_d.size(); ++k) {
    m_scale.push_back(std::max(local_mean(N_d, k, reach), k < m_first ? 0.0 : lowest));
    if (k >= m_first) m_carrier.push_back(std::max(shape[k], lowest) / m_scale[k]);
  }
  if (tooth_period > 0.0) remove_teeth(tooth_period / step);
  set_memories(step);
}

/// Judged N_d over its local mean.
std::vector<double> CurveScatter::relative() const {
  std::vector<double> result;
  for (std::size_t k = m_first; k < m_scale.size(); ++k) {
    result.push_back(m_resistance[k] / m_scale[k]);
  }
  return result;
}

void CurveScatter::add(std::span<const double> heights, std::vector<double>& N_d) const {
  for (std::size_t j = 0; j < heights.size(); ++j) {
    for (std::size_t k = 0; k < N_d.size(); ++k) N_d[k] += m_scale[k] * heights[j] * m_teeth[j][k];
  }
}

/// Takes off the teeth less the share of them that is due to chance.
void CurveScatter::remove_teeth(double period) {
  if (static_cast<double>(m_carrier.size()) < fewest_teeth * period) return;
  Columns columns = waves(m_first, m_carrier.size(), period);
  add_spline(columns, m_carrier, period);
  const auto fits = regressions(columns, relative());
  if (fits.empty()) return;
  const auto& [_, coefficients, variances] = likeliest(fits);
  m_teeth = waves(0, m_scale.size(), period);
  double power = 0.0, chance = 0.0;
  for (std::size_t j = 0; j < m_teeth.size(); ++j) {
    power += coefficients[j] * coefficients[j];
    chance += variances[j];
    m_tooth_deviations.push_back(std::sqrt(variances[j]));
  }
  std::vector<double> heights(coefficients.begin(), coefficients.begin() + 2 * harmonics);
  for (double& height : heights) height *= -std::max(0.0, 1.0 - chance / power);
  add(heights, m_resistance);
}

void CurveScatter::set_memories(double step) {
  const std::vector<double> target = relative();
  const auto rows = static_cast<double>(target.size());
  double lowest = std::numeric_limits<double>::infinity();
  for (const double bend : bends) {
    Columns columns;
    add_spline(columns, m_carrier, bend / step);
    const auto fits = regressions(columns, target);
    if (criterion(fits, rows) >= lowest) continue;
    lowest = criterion(fits, rows);
    m_freedom = rows - static_cast<double>(columns.size());
    m_memories.clear();
    for (const Regression& fit : fits) m_memories.push_back(fit.memory);
  }
}

const CurveScatter::Memory& CurveScatter::drawn_memory(std::mt19937_64& engine) const {
  double highest = m_memories.front().likelihood, total = 0.0;
  for (const Memory& memory : m_memories) highest = std::max(highest, memory.likelihood);
  for (const Memory& memory : m_memories) total += std::exp(memory.likelihood - highest);
  double left = total * uniform(engine);
  for (const Memory& memory : m_memories) {
    left -= std::exp(memory.likelihood - highest);
    if (left <= 0.0) return memory;
  }
  return m_memories.back();
}

std::vector<double> CurveScatter::with_more(std::mt19937_64& engine) const {
  std::vector<double> N_d = m_resistance;
  if (!can_be_judged()) return N_d;
  const Memory& memory = drawn_memory(engine);
  const double deviation = std::sqrt(memory.squares / chi_squared(m_freedom, engine));
  double scatter = deviation * normal(engine) / std::sqrt(1.0 - memory.phi * memory.phi);
  for (std::size_t k = 0; k < N_d.size(); ++k) {
    N_d[k] += m_scale[k] * scatter;
    scatter = memory.phi * scatter + deviation * normal(engine);
  }
  std::vector<double> heights = m_tooth_deviations;
  for (double& height : heights) height *= normal(engine);
  add(heights, N_d);
  return N_d;
}

}  // namespace mpm::analysis

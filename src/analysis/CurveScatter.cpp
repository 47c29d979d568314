#include "mpm/analysis/CurveScatter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mpm::analysis {
namespace {

using Columns = std::vector<std::vector<double>>;

constexpr int harmonics = 3;
constexpr double longest_memory = 0.8;
constexpr double memory_spacing = 0.05;
/// Below this share of the largest N_d the curve bends too sharply for its scatter to be judged.
constexpr double judged_from = 0.25;

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

void add_spline(Columns& columns, std::size_t rows, double step, double bend) {
  const double length = static_cast<double>(rows - 1);
  const int spans = std::max(1, static_cast<int>(std::lround(length * step / bend)));
  for (int j = -1; j <= spans + 1; ++j) {
    auto& column = columns.emplace_back(rows);
    for (std::size_t k = 0; k < rows; ++k) {
      column[k] = bump(static_cast<double>(k) * spans / length - j);
    }
  }
}

double wave(std::size_t term, double phase) {
  const double angle = 2.0 * std::numbers::pi * static_cast<double>(term / 2 + 1) * phase;
  return term % 2 == 0 ? std::sin(angle) : std::cos(angle);
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

}  // namespace

CurveScatter::CurveScatter(std::span<const double> N_d, std::span<const double> shape, double step,
                           const ScatterOptions& options)
    : m_step(step), m_tooth_period(options.tooth_period), m_smooth(N_d.begin(), N_d.end()) {
  const double largest = *std::max_element(N_d.begin(), N_d.end());
  const auto first = std::find_if(N_d.begin(), N_d.end(),
                                  [&](double value) { return value >= judged_from * largest; });
  m_first = static_cast<std::size_t>(first - N_d.begin());
  for (const double value : shape) m_scale.push_back(std::max(value, judged_from * largest));
  for (std::size_t k = 0; k < m_first; ++k) m_scale[k] = std::abs(N_d[k]);

  const std::size_t rows = N_d.size() - m_first;
  Columns columns;
  add_spline(columns, rows, step, options.bend);
  const std::size_t first_tooth = columns.size();
  for (std::size_t term = 0; m_tooth_period > 0.0 && term < 2 * harmonics; ++term) {
    auto& column = columns.emplace_back();
    for (std::size_t k = m_first; k < N_d.size(); ++k) {
      column.push_back(wave(term, static_cast<double>(k) * step / m_tooth_period));
    }
  }
  m_freedom = static_cast<double>(rows) - static_cast<double>(columns.size());
  std::vector<double> relative;
  for (std::size_t k = m_first; k < N_d.size(); ++k) relative.push_back(N_d[k] / m_scale[k]);

  for (int k = 0; k * memory_spacing <= longest_memory + 1e-9; ++k) {
    m_memories.push_back(fit(columns, relative, k * memory_spacing));
  }
  const Memory& best = *std::max_element(
      m_memories.begin(), m_memories.end(),
      [](const Memory& a, const Memory& b) { return a.likelihood < b.likelihood; });
  columns.resize(first_tooth);
  set_smooth(best, columns);
  if (m_tooth_period > 0.0) set_teeth(best, first_tooth);
}

CurveScatter::Memory CurveScatter::fit(const Columns& columns, const std::vector<double>& relative,
                                       double phi) const {
  const std::size_t size = columns.size();
  Columns white;
  for (const auto& column : columns) white.push_back(whitened(column, phi));
  const std::vector<double> target = whitened(relative, phi);
  Columns factor(size, std::vector<double>(size));
  std::vector<double> right(size);
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) factor[i][j] = dot(white[i], white[j]);
    right[i] = dot(white[i], target);
  }
  factorize(factor);

  Memory memory{.phi = phi, .coefficients = solve(factor, right)};
  const double explained = dot(memory.coefficients, right);
  memory.squares = std::max(dot(target, target) - explained, 1e-14 * dot(target, target));
  memory.likelihood = 0.5 * std::log(1.0 - phi * phi) - 0.5 * m_freedom * std::log(memory.squares);
  for (std::size_t i = 0; i < size; ++i) {
    memory.likelihood -= std::log(factor[i][i]);
    std::vector<double> unit(size, 0.0);
    unit[i] = 1.0;
    memory.variances.push_back(solve(factor, unit)[i] * memory.squares / m_freedom);
  }
  return memory;
}

void CurveScatter::set_smooth(const Memory& best, const Columns& columns) {
  for (std::size_t k = m_first; k < m_smooth.size(); ++k) {
    double sum = 0.0;
    for (std::size_t j = 0; j < columns.size(); ++j) {
      sum += best.coefficients[j] * columns[j][k - m_first];
    }
    m_smooth[k] = m_scale[k] * sum;
  }
}

/// Teeth less the share that scatter alone would show at their period.
void CurveScatter::set_teeth(const Memory& best, std::size_t first_tooth) {
  double power = 0.0, chance = 0.0;
  for (std::size_t j = first_tooth; j < best.coefficients.size(); ++j) {
    m_teeth.push_back(best.coefficients[j]);
    power += best.coefficients[j] * best.coefficients[j];
    chance += best.variances[j];
  }
  const double share = power > 0.0 ? std::sqrt(std::max(0.0, 1.0 - chance / power)) : 0.0;
  for (double& coefficient : m_teeth) coefficient *= share;
}

double CurveScatter::teeth(double u_over_D) const {
  double sum = 0.0;
  for (std::size_t term = 0; term < m_teeth.size(); ++term) {
    sum += m_teeth[term] * wave(term, u_over_D / m_tooth_period);
  }
  return sum;
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

std::vector<double> CurveScatter::draw(std::mt19937_64& engine) const {
  const Memory& memory = drawn_memory(engine);
  const double deviation = std::sqrt(memory.squares / chi_squared(m_freedom, engine));
  const double shift = m_tooth_period * uniform(engine);
  std::vector<double> N_d = m_smooth;
  double scatter = deviation * normal(engine) / std::sqrt(1.0 - memory.phi * memory.phi);
  for (std::size_t k = 0; k < N_d.size(); ++k) {
    N_d[k] += m_scale[k] * (scatter + teeth(static_cast<double>(k) * m_step + shift));
    scatter = memory.phi * scatter + deviation * normal(engine);
  }
  return N_d;
}

}  // namespace mpm::analysis

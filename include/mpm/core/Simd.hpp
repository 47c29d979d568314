#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

/// Four doubles at a time. A Pack is a compiler vector (GCC and Clang): the same source becomes
/// AVX2, SSE2 or NEON, whatever the library is built for, and arithmetic and comparisons are
/// written as with doubles. The functions below exist for Pack and double alike, so that an
/// equation can be written once as a template over both. Packs stay inside functions: in the
/// signature of anything that is not inlined their calling convention would depend on the target.
namespace mpm::simd {

inline constexpr int lanes = 4;
/// Size of a pack, and the alignment to ask for where packs lie in memory: the compiler's own
/// depends on the target, and libraries and programs for different targets share structures.
inline constexpr int pack_bytes = lanes * sizeof(double);

using Pack [[gnu::vector_size(pack_bytes)]] = double;
/// What a comparison of packs gives: all bits of a lane set where it holds.
using Mask [[gnu::vector_size(pack_bytes)]] = std::int64_t;

/// What the library that says so is built for.
#if defined(__AVX2__) && defined(__FMA__)
inline constexpr const char* instruction_set = "AVX2 and FMA";
#elif defined(__SSE2__)
inline constexpr const char* instruction_set = "SSE2";
#elif defined(__ARM_NEON)
inline constexpr const char* instruction_set = "NEON";
#else
inline constexpr const char* instruction_set = "plain";
#endif

inline Pack broadcast(double x) {
  return Pack{x, x, x, x};
}

/// From an address of any alignment.
inline Pack load(const double* from) {
  Pack x;
  std::memcpy(&x, from, sizeof x);
  return x;
}
inline void store(double* to, Pack x) {
  std::memcpy(to, &x, sizeof x);
}
/// The first `count` lanes, 1 to 4; further ones repeat the last of these.
[[gnu::always_inline]] inline Pack load(const double* from, int count) {
  if (count == lanes) return load(from);
  Pack x;
  for (int lane = 0; lane < lanes; ++lane) x[lane] = from[lane < count ? lane : count - 1];
  return x;
}
[[gnu::always_inline]] inline void store(double* to, Pack x, int count) {
  if (count == lanes) return store(to, x);
  for (int lane = 0; lane < count; ++lane) to[lane] = x[lane];
}

/// visit(first, n) for groups of four, n = 4, and for what is left, n < 4.
template <class Visit>
void for_each_group(int count, const Visit& visit) {
  int first = 0;
  for (; first + lanes <= count; first += lanes) visit(first, lanes);
  if (first < count) visit(first, count - first);
}

/// Order of additions: (0 + 2) + (1 + 3).
inline double sum(Pack x) {
  return (x[0] + x[2]) + (x[1] + x[3]);
}

/// The sums of four packs, one in each lane; the same order of additions in all.
inline Pack sums(Pack a, Pack b, Pack c, Pack d) {
  const Pack ab =
      __builtin_shufflevector(a, b, 0, 4, 2, 6) + __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Pack cd =
      __builtin_shufflevector(c, d, 0, 4, 2, 6) + __builtin_shufflevector(c, d, 1, 5, 3, 7);
  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

inline bool any(Mask m) {
  return ((m[0] | m[2]) | (m[1] | m[3])) != 0;
}
inline bool all(Mask m) {
  return ((m[0] & m[2]) & (m[1] & m[3])) != 0;
}

inline Pack select(Mask m, Pack yes, Pack no) {
  return m ? yes : no;
}
inline double select(bool m, double yes, double no) {
  return m ? yes : no;
}

/// NaN in the first argument stays.
template <class Real>
Real max(Real a, Real b) {
  return select(a < b, b, a);
}
template <class Real>
Real min(Real a, Real b) {
  return select(a > b, b, a);
}
template <class Real>
Real abs(Real a) {
  return select(a < Real{}, -a, a);
}

inline double sqrt(double x) {
  return std::sqrt(x);
}
inline Pack sqrt(Pack x) {
  return Pack{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
}

inline double exp(double x) {
  return std::exp(x);
}

namespace detail {
/// Adding it leaves the nearest integer in the low bits of the mantissa.
inline constexpr double integer_shift = 6755399441055744.0;  // 1.5 2^52
inline constexpr double ln2_high = 0x1.62e42fefa0000p-1;     // exact times any exponent
inline constexpr double ln2_low = 0x1.cf79abc9e3b3ap-40;

/// Bits of doubles as whole numbers without sign, whose sums may wrap.
using Bits [[gnu::vector_size(pack_bytes)]] = std::uint64_t;

template <class To, class From>
To same_bits(From from) {
  static_assert(sizeof(To) == sizeof(From));
  To to;
  std::memcpy(&to, &from, sizeof to);
  return to;
}
inline Bits bits(Pack x) {
  return same_bits<Bits>(x);
}
inline Pack from_bits(Bits m) {
  return same_bits<Pack>(m);
}
}  // namespace detail

/// Within 1 ulp between exp(-708) and exp(709), to which the argument is limited; NaN stays.
/// x = k ln 2 + r with |r| <= ln(2)/2, and the power series of exp(r).
[[gnu::always_inline]] inline Pack exp(Pack x) {
  using namespace detail;
  x = min(max(x, broadcast(-708.0)), broadcast(709.0));
  const Pack shifted = x * 1.4426950408889634 + integer_shift;
  const Pack k = shifted - integer_shift;
  const Pack r = (x - k * ln2_high) - k * ln2_low;
  const Pack r2 = r * r, r4 = r2 * r2;
  const Pack p01 = r * (1.0 / 6.0) + 0.5;  // of r^2 to r^13, in pairs and fours
  const Pack p23 = r * (1.0 / 120.0) + 1.0 / 24.0;
  const Pack p45 = r * (1.0 / 5040.0) + 1.0 / 720.0;
  const Pack p67 = r * (1.0 / 362880.0) + 1.0 / 40320.0;
  const Pack p89 = r * (1.0 / 39916800.0) + 1.0 / 3628800.0;
  const Pack pab = r * (1.0 / 6227020800.0) + 1.0 / 479001600.0;
  const Pack low = p23 * r2 + p01, middle = p67 * r2 + p45, high = pab * r2 + p89;
  const Pack series = ((high * r4 + middle) * r4 + low) * r2 + r + 1.0;
  return from_bits(bits(series) + (bits(shifted) << 52));
}

inline double log(double x) {
  return std::log(x);
}

/// Within 2 ulp for positive normal numbers; NaN elsewhere. x = 2^k m with m around 1, and
/// log m = 2 atanh((m - 1)/(m + 1)) by its power series.
[[gnu::always_inline]] inline Pack log(Pack x) {
  using namespace detail;
  constexpr std::uint64_t half_root = 0x3fe6a09e667f3bcd;  // bits of sqrt(1/2)
  const Bits k = same_bits<Bits>(Mask(same_bits<Mask>(bits(x) - half_root) >> 52));
  const Pack m = from_bits(bits(x) - (k << 52));
  const Pack k_real = from_bits(k + bits(broadcast(integer_shift))) - integer_shift;
  const Pack f = m - 1.0;
  const Pack s = f / (f + 2.0);
  const Pack z = s * s, z2 = z * z, z4 = z2 * z2;
  const Pack a = z * (2.0 / 5.0) + 2.0 / 3.0, b = z * (2.0 / 9.0) + 2.0 / 7.0;
  const Pack c = z * (2.0 / 13.0) + 2.0 / 11.0, d = z * (2.0 / 17.0) + 2.0 / 15.0;
  const Pack e = z * (2.0 / 21.0) + 2.0 / 19.0;
  const Pack tail = (e * z4 + (d * z2 + c)) * z4 + (b * z2 + a);
  // log(1 + f) = f - s (f - z tail): f is exact, the rest small.
  const Pack log_m = f - s * (f - z * tail);
  const Pack result = k_real * ln2_high + (k_real * ln2_low + log_m);
  return select(x >= std::numeric_limits<double>::min(), result,
                broadcast(std::numeric_limits<double>::quiet_NaN()));
}

}  // namespace mpm::simd

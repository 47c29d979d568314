#pragma once

#include <array>
#include <string>

#include "mpm/material/SandParameters.hpp"

namespace mpm::material {

/// A way to read the equations of the sand law, for tests that hold under all of them.
struct SandReading {
  const char* name;
  void (*choose)(SandConstants& sand);
};

inline constexpr std::array sand_readings{
    SandReading{"normalized", [](SandConstants&) {}},
    SandReading{"plain", [](SandConstants& sand) { sand.softening = Softening::plain; }},
    SandReading{"explicit",
                [](SandConstants& sand) { sand.softening = Softening::explicit_ratio; }},
    SandReading{"power_line",
                [](SandConstants& sand) {
                  sand.xi = 0.65;
                  sand.lambda_c = 0.021;
                }},
    SandReading{"lode", [](SandConstants& sand) { sand.dilatancy = Dilatancy::lode; }},
    SandReading{"lode_explicit",
                [](SandConstants& sand) {
                  sand.dilatancy = Dilatancy::lode;
                  sand.softening = Softening::explicit_ratio;
                }},
    SandReading{"power_bulk",
                [](SandConstants& sand) {
                  sand.bulk = BulkModulus::power;
                  sand.bulk_xi = 0.7;
                }},
    SandReading{"poisson_bulk",
                [](SandConstants& sand) {
                  sand.bulk = BulkModulus::poisson;
                  sand.poisson_ratio = 0.13;
                }},
    SandReading{"all_together", [](SandConstants& sand) {
                  sand.dilatancy = Dilatancy::lode;
                  sand.c = 0.71;
                  sand.xi = 0.7;
                  sand.lambda_c = 0.019;
                  sand.bulk = BulkModulus::power;
                  sand.bulk_xi = 0.15;
                }}};

inline std::string name_of_reading(std::size_t reading) {
  return sand_readings.at(reading).name;
}

}  // namespace mpm::material

#pragma once

#include "mpm/contact/Motion.hpp"

namespace mpm::scene {
using contact::Ramp;
}

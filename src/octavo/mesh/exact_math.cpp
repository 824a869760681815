// SPDX-License-Identifier: MIT
#include "octavo/mesh/exact_math.h"

namespace octavo::exact {

[[gnu::noinline]] vec3 to_floats(const dvec3& p) {
    return vec3(p);
}

}  // namespace octavo::exact

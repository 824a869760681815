// SPDX-License-Identifier: MIT
#include "octavo/mesh/samples.h"

#include <string>

#include "octavo/core/error.h"
#include "octavo/mesh/sample_scenes.h"

namespace octavo {
namespace {

constexpr double kMinSize = 0.0001;
constexpr double kMaxSize = 100.0;

constexpr SampleInfo kSamples[] = {
    {"courtyard", "an arcaded court with a fountain, cloth, plants and lanterns", 280'000},
    {"hairball", "thousands of thin curled tubes in a ball", 2'800'000},
    {"scan", "a rough stone as a laser scanner would see it", 10'000'000},
    {"city", "three kilometres of hills and streets, mostly empty", 2'000'000},
};
constexpr Scene (*kMakers[])(double) = {scenes::courtyard, scenes::hairball, scenes::scan,
                                        scenes::city};
static_assert(std::size(kSamples) == std::size(kMakers));

}  // namespace

std::span<const SampleInfo> samples() {
    return kSamples;
}

Scene make_sample(std::string_view name, double size) {
    if (!(size >= kMinSize && size <= kMaxSize))
        throw Error(Errc::bad_argument, "a sample's size is from 0.0001 to 100");
    std::string names;
    for (std::size_t i = 0; i < std::size(kSamples); ++i) {
        if (name == kSamples[i].name) return kMakers[i](size);
        names += (i == 0 ? "" : ", ") + std::string(kSamples[i].name);
    }
    throw Error(Errc::bad_argument,
                "there is no sample '" + std::string(name) + "'; there are " + names);
}

}  // namespace octavo

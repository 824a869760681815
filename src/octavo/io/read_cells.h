// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "octavo/io/model.h"
#include "octavo/io/reading.h"
#include "octavo/io/section_source.h"

/// The sections of a file that hold something for each cell of a level: attributes and light. What
/// is wrong is thrown or collected as Reading says; where it cannot be used, what is returned is
/// empty and reading.usable is false.
namespace octavo::octv {

/// @param dag      of the same file, checked
/// @param summary  what the metadata says of the attributes
[[nodiscard]] Attributes read_attributes(SectionSource& source,
                                         const std::vector<Section>& sections, const Dag& dag,
                                         const AttributeSummary& summary, Reading& reading);

/// @param model  with the metadata and the attributes of the same file
[[nodiscard]] CellLight read_light(SectionSource& source, const std::vector<Section>& sections,
                                   const Model& model, Reading& reading);

}  // namespace octavo::octv

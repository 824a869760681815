// SPDX-License-Identifier: MIT
#pragma once

/// Octavo: sparse voxel DAGs from triangle scenes, up to 131072^3 voxels.
///
/// This header is the whole public story, in the order in which one uses it:
///
///     #include <octavo/octavo.h>
///
///     octavo::Scene scene = octavo::load_scene("scene.glb");
///     octavo::BuildOptions options{.depth = 10};                     // 1024^3
///     octavo::Model model = octavo::make_model(
///         "scene.glb", scene, options.rule, octavo::build(scene, options));
///     octavo::write_octv("scene.octv", model);
///
///     octavo::Hit hit = octavo::trace_closest(model.dag, model.grid(),
///                                             {.origin = {0, 10, 0}, .direction = {0, -1, 0}});
///     octavo::write_image("scene.png", octavo::render(model.dag, model.grid(), {}));
///
/// Everything is in namespace octavo. Functions that can fail throw octavo::Error; nothing prints,
/// nothing exits. Long work takes a ProgressFunction, which also stops it. A Dag never changes once
/// it is built: any number of threads may read and trace it, and copies share its words.

// Words everyone uses.
#include "octavo/core/error.h"  // Error: the one exception type, with a code, a file and an offset
#include "octavo/core/grid.h"   // Grid: N^3 voxels placed in the world; smallest_cube
#include "octavo/core/parallel.h"  // with_threads: how many threads the work inside may use
#include "octavo/core/progress.h"  // ProgressFunction: how far work has come, and how to stop it
#include "octavo/core/version.h"   // kVersion, kCommit

// Triangles in: a Scene from a file or made by code, and back into a file.
#include "octavo/mesh/load.h"
#include "octavo/mesh/samples.h"
#include "octavo/mesh/save.h"
#include "octavo/mesh/scene.h"

// Triangles to voxels to a DAG.
#include "octavo/construct/build.h"     // build: a Scene and BuildOptions -> a Dag and its Grid
#include "octavo/construct/estimate.h"  // estimate_build: what a build will take
#include "octavo/voxelize/rule.h"       // VoxelRule: which voxels a triangle marks

// The thing itself.
#include "octavo/dag/dag.h"         // Dag: one array of 32-bit words
#include "octavo/dag/node.h"        // what the words mean
#include "octavo/dag/statistics.h"  // compute_statistics: voxels, nodes and bytes by level

// What the voxels look like.
#include "octavo/attributes/attributes.h"        // Attributes: colour, emission, normal by cell
#include "octavo/attributes/build_attributes.h"  // build_attributes: from the scene's triangles

// The .octv file.
#include "octavo/io/model.h"     // Model: a Dag, its Grid and where it came from
#include "octavo/io/octv.h"      // write_octv, read_octv, read_octv_summary
#include "octavo/io/validate.h"  // validate_octv: all that is wrong with a file

// Rays, one at a time or many.
#include "octavo/trace/trace.h"  // Ray, Hit; trace_closest, trace_any

// Light that surfaces send on, stored for each cell.
#include "octavo/light/light_cells.h"  // light_cells: lamps, sky and shining cells -> CellLight
#include "octavo/light/lit_scene.h"    // LitScene: several DAGs with their places, lamps and a sky

// Pictures.
#include "octavo/render/camera.h"      // look_at, default_camera; sun_at, default_sun
#include "octavo/render/image.h"       // Image; write_png, write_exr
#include "octavo/render/render.h"      // render: camera, sun, shadow, ambient occlusion
#include "octavo/render/render_lit.h"  // render_lit: with the light of the cells, or by paths
#include "octavo/render/visibility.h"  // shadow and ambient occlusion for a rasteriser's G-buffer

// The same on GPUs.
#include "octavo/backend/device.h"  // list_devices, open_device

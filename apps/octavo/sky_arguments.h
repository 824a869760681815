// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "octavo/light/sky.h"

/// How the command line writes skies:
///
///     clear                        the blue sky of the pictures
///     none
///     color:R,G,B                  the same everywhere
///     gradient:zenith=R,G,B:horizon=R,G,B:ground=R,G,B
///     FILE.exr, FILE.hdr           a picture of the whole sphere; :turn=DEGREES turns it
///
/// and behind any of them :power=FACTOR.
namespace octavo::cli {

/// @throws Error  bad_argument, saying what was expected; as load_sky_image()
[[nodiscard]] Sky parse_sky(const std::string& text, const dvec3& up);
/// The same of a text that a stranger may have written: its picture is named as from this folder,
/// and none outside it is opened.
[[nodiscard]] Sky parse_confined_sky(const std::string& text, const dvec3& up,
                                     const std::filesystem::path& folder);

/// The sky as a file has it that was lit by it: a picture is named as from the file's folder.
[[nodiscard]] std::string stored_sky(const std::string& text, const std::filesystem::path& file);
/// Is `text`, which names a picture as from here, the sky that the file was lit by?
[[nodiscard]] bool is_stored_sky(const std::string& text, const std::string& stored,
                                 const std::filesystem::path& file);
/// The sky that a file was lit by, read as by parse_confined_sky().
/// @throws Error  bad_input, naming the file; as load_sky_image()
[[nodiscard]] Sky parse_stored_sky(const std::string& stored, const dvec3& up,
                                   const std::filesystem::path& file);

/// The picture that a sky's text names; empty where it names none.
[[nodiscard]] std::filesystem::path sky_picture(const std::string& text);

}  // namespace octavo::cli

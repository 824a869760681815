// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace octavo::cli {

/// Speeds frame by frame, one curve for each thing that was measured.
struct PlotPanel {
    struct Curve {
        std::string name;
        std::vector<double> values;  // one for each frame
    };
    std::string title;
    std::vector<Curve> curves;
};

/// Draws the panels side by side, each with its own scale from 0, as SVG. Curves of one name have
/// one colour. @throws Error io
void write_plot(const std::filesystem::path& file, const std::string& caption,
                const std::vector<PlotPanel>& panels);

}  // namespace octavo::cli

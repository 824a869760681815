// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <filesystem>
#include <vector>

#include "octavo/io/finding.h"
#include "octavo/io/octv.h"

/// How read_octv and validate_octv share one reader: the first throws what is wrong, the second
/// collects it. Everything that one refuses the other finds, as there is no second text.
namespace octavo {

/// One file being read.
struct Reading {
    const std::filesystem::path& path;
    OctvReadOptions options = {};
    OctvReadTimes times = {};

    // For validate_octv; read_octv throws the first finding.
    bool collect = false;
    bool strict = false;
    std::size_t max_findings = 1;
    std::vector<Finding> findings = {};
    bool usable = true;  // all that was read so far
    std::uint64_t metadata_offset = 0;
    std::uint64_t decompressed_bytes = 0;  // of all sections so far

    /// Runs a check, which throws an Error where something is wrong with the content.
    template <typename Check>
    void check(double& seconds, const Check& work) {
        const auto begin = std::chrono::steady_clock::now();
        try {
            work();
        } catch (const Error& error) {
            if (!collect || error.code() == Errc::io || error.code() == Errc::cancelled) throw;
            add(finding_of(error));
        }
        const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
        seconds += passed.count();
    }
    /// @param strict_only  what was read can be used all the same
    void add(Finding finding, bool strict_only = false) {
        usable = usable && strict_only;
        if (findings.size() < max_findings) findings.push_back(std::move(finding));
    }
};

/// Reads a file as read_octv says. Where findings are collected, what cannot be read because of
/// them is left out of the model. What one section's reader throws inside check() becomes a
/// finding, and the sections after it are still looked at.
[[nodiscard]] Model read_model(Reading& reading);

}  // namespace octavo

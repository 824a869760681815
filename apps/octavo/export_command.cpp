// SPDX-License-Identifier: MIT
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "arguments.h"
#include "commands.h"
#include "help.h"
#include "octavo/core/atomic_file.h"
#include "octavo/core/error.h"
#include "octavo/io/mapped_file.h"
#include "octavo/io/octv.h"
#include "output.h"
#include "viewer_page.h"

namespace octavo::cli {
namespace {

constexpr const char* kExamples =
    "  octavo export scene.octv --html site/            # a folder for any web server\n"
    "  octavo export scene.octv --html scene.html       # one file, to mail and to open from a "
    "disk\n";

/// Above this, browsers take long to open the file or refuse.
constexpr std::uint64_t kMaxInlineBytes = std::uint64_t{256} << 20;
constexpr std::size_t kPieceBytes = std::size_t{4} << 20;

struct ExportArguments {
    std::filesystem::path file;
    std::filesystem::path html;
    bool single_file = false;
    bool force = false;
};

/// Writes one piece after the other.
class Appender {
public:
    explicit Appender(const std::filesystem::path& file) : file_(file) {}
    void operator()(std::string_view text) {
        file_.write(at_, std::as_bytes(std::span(text)));
        at_ += text.size();
    }
    void commit() { file_.commit(); }

private:
    AtomicFile file_;
    std::uint64_t at_ = 0;
};

void write_file(const std::filesystem::path& file, std::span<const std::byte> bytes) {
    AtomicFile out(file);
    for (std::size_t at = 0; at < bytes.size(); at += kPieceBytes)
        out.write(at, bytes.subspan(at, std::min(kPieceBytes, bytes.size() - at)));
    out.commit();
}

void export_single(const ExportArguments& arguments, std::span<const std::byte> bytes) {
    if (bytes.size() > kMaxInlineBytes)
        throw Error(Errc::limit, arguments.file,
                    "too large for a page of one file (256 MiB); export a folder");
    check_output(arguments.html, arguments.force, {arguments.file});
    Appender out(arguments.html);
    write_single_page(arguments.file.filename().string(), bytes,
                      [&out](std::string_view text) { out(text); });
    out.commit();
}

void export_folder(const ExportArguments& arguments, std::span<const std::byte> bytes) {
    const std::filesystem::path folder = arguments.html;
    check_output_name(folder);
    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    if (failed) throw Error(Errc::io, folder, "cannot make the folder: " + failed.message());
    check_output(folder / "index.html", arguments.force, {arguments.file});
    check_output(folder / "scene.octv", arguments.force);
    write_file(folder / "scene.octv", bytes);
    const std::string page =
        configured_page({{"name", arguments.file.filename().string()}, {"url", "scene.octv"}});
    write_file(folder / "index.html", std::as_bytes(std::span(page)));
}

void run_export(const ExportArguments& arguments) {
    (void)viewer_page();
    (void)read_octv(arguments.file);  // nobody is sent a damaged file
    // A copy: what is mapped ends the process where somebody cuts it off meanwhile.
    FileCopy file(arguments.file);
    file.fetch(0, file.bytes().size());
    if (arguments.single_file || arguments.html.extension() == ".html")
        export_single(arguments, file.bytes());
    else
        export_folder(arguments, file.bytes());
}

}  // namespace

void add_export_command(CLI::App& program) {
    CLI::App& command =
        *program.add_subcommand("export", "Write the viewer and a scene for a web server");
    const auto arguments = std::make_shared<ExportArguments>();
    set_help(command, kExamples);
    command.add_option("FILE", arguments->file, "An .octv file")->required()->type_name("");
    command
        .add_option(
            "--html", arguments->html,
            "The folder to write: a page and the scene; or one file whose name ends in .html")
        ->required()
        ->type_name("OUT");
    command.add_flag("--single-file", arguments->single_file,
                     "One HTML file with the scene inside, whatever its name");
    add_force(command, arguments->force, "Replace files where they exist");
    command.callback([arguments] { run_export(*arguments); });
}

}  // namespace octavo::cli

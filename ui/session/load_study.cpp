#include "ui/session/load_study.hpp"

#include <filesystem>
#include <vector>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/library/shipped.hpp"

namespace palpate::ui {
namespace {

namespace fs = std::filesystem;

/// What is called much like a file that is not there: TOML files beside it, and shipped protocols.
std::string nearest(const fs::path& absent) {
    constexpr std::size_t kMax = 1000;  // files of a folder
    std::vector<std::string> names;
    std::error_code unknown;
    const fs::path folder = absent.has_parent_path() ? absent.parent_path() : fs::path(".");
    for (fs::directory_iterator at(folder, unknown), end;
         !unknown && at != end && names.size() < kMax; at.increment(unknown)) {
        if (at->path().extension() == ".toml") {
            names.push_back(at->path().filename().string());
        }
    }
    if (!absent.has_parent_path()) {
        for (const protocols::ShippedProtocol& shipped : protocols::shipped_protocols()) {
            names.emplace_back(shipped.name);
        }
    }
    return suggestion(absent.filename().string(), names,
                      ": check the path, or give the name of a shipped one");
}

}  // namespace

Study load_study(const std::string& file_or_name) {
    Study study;
    const auto parse = [&]() -> protocols::Protocol {
        if (std::error_code unknown; fs::exists(file_or_name, unknown)) {
            return protocols::load_protocol(file_or_name);
        }
        for (const protocols::ShippedProtocol& shipped : protocols::shipped_protocols()) {
            if (shipped.name == file_or_name) {
                return protocols::parse_protocol(shipped.text, shipped.name);
            }
        }
        throw protocols::ProtocolError(fmt::format("{}:1:1: there is no such protocol{}",
                                                   file_or_name, nearest(file_or_name)));
    };
    study.protocol = parse();
    study.hash = protocols::protocol_hash(study.protocol);
    return study;
}

}  // namespace palpate::ui

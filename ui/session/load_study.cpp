#include "ui/session/load_study.hpp"

#include <filesystem>
#include <vector>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/library/shipped.hpp"
#include "protocols/order/constrained_order.hpp"

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

std::string protocol_text(const std::string& file_or_name) {
    if (std::error_code unknown; fs::exists(file_or_name, unknown)) {
        return protocols::read_text(file_or_name, protocols::kMaxDocument);
    }
    for (const protocols::ShippedProtocol& shipped : protocols::shipped_protocols()) {
        if (shipped.name == file_or_name) {
            return std::string(shipped.text);
        }
    }
    throw protocols::ProtocolError(
        fmt::format("{}:1:1: there is no such protocol{}", file_or_name, nearest(file_or_name)));
}

/// Where the first limit of runs stands, or its table.
protocols::Position limits_of(const std::string& text, const std::string& file) {
    protocols::Position table_at{};
    for (const protocols::Entry& entry : protocols::parse_document(text, file)) {
        const auto* table = std::get_if<protocols::Table>(&entry.value.data);
        table_at = entry.key == "design" || entry.key == "procedure" ? entry.value.at : table_at;
        for (const protocols::Entry& key : table != nullptr ? *table : protocols::Table()) {
            if (key.key.starts_with("max_run")) {
                return key.value.at;
            }
        }
    }
    return table_at;
}

}  // namespace

Study load_study(const std::string& file_or_name) {
    const std::string text = protocol_text(file_or_name);
    Study study{.protocol = protocols::parse_protocol(text, file_or_name), .hash = {}};
    study.hash = protocols::protocol_hash(study.protocol);
    try {  // whether there is an order, before anything is made
        static_cast<void>(make_plan(study.protocol, study.hash, {"P1", 1}, study.protocol.seed));
    } catch (const protocols::OrderError& e) {
        const protocols::Position at = limits_of(text, file_or_name);
        throw protocols::ProtocolError(
            fmt::format("{}:{}:{}: {}", file_or_name, at.line, at.column, e.what()));
    }
    return study;
}

}  // namespace palpate::ui

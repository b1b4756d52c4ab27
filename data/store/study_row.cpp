#include "data/store/study_row.hpp"

#include <fmt/format.h>

#include "engine/base/sha256.hpp"
#include "protocols/file/protocol_file.hpp"

namespace palpate::data {

std::vector<ChainBreak> study_breaks(Database& database, std::int64_t study) {
    std::vector<ChainBreak> breaks;
    const auto expect = [&](const char* what, std::string stored, std::string wanted) {
        if (stored != wanted) {
            breaks.push_back({0, what, std::move(stored), std::move(wanted)});
        }
    };
    Statement row = database.prepare(
        "SELECT protocol_sha256, study_name, study_title, protocol_toml FROM study WHERE study_id "
        "= ?1",
        study);
    if (!row.step()) {
        return breaks;
    }
    const std::string text = row.text(3);
    expect("study.protocol_sha256", row.text(0), sha256_hex(text));
    try {
        const protocols::Protocol protocol = protocols::stored_protocol(text);
        expect("study.study_name", row.text(1), protocol.id);
        expect("study.study_title", row.text(2), protocol.title);
    } catch (const protocols::ProtocolError& e) {
        breaks.push_back({0, "study.protocol_toml", e.what(), "a protocol"});
    }
    return breaks;
}

void require_study(Database& database, std::int64_t study) {
    const std::vector<ChainBreak> breaks = study_breaks(database, study);
    if (!breaks.empty()) {
        throw StoreError(fmt::format(
            "{}: the study {} is not what it was: {} is damaged or was changed; go on in a copy "
            "from before that",
            database.file(),
            database.first("SELECT study_name FROM study WHERE study_id = ?1", study).text(0),
            breaks[0].what));
    }
}

}  // namespace palpate::data

#include "ui/cli/load_study.hpp"

#include <filesystem>

#include "protocols/format/protocol_file.hpp"
#include "protocols/library/shipped.hpp"

namespace palpate::ui {

Study load_study(const std::string& file_or_name) {
    Study study;
    const auto parse = [&]() -> protocols::Protocol {
        std::error_code ignored;
        if (!std::filesystem::exists(file_or_name, ignored)) {
            for (const protocols::ShippedProtocol& shipped : protocols::shipped_protocols()) {
                if (shipped.name == file_or_name) {
                    return protocols::parse_protocol(shipped.text, shipped.name);
                }
            }
        }
        return protocols::load_protocol(file_or_name);
    };
    study.protocol = parse();
    study.hash = protocols::protocol_hash(study.protocol);
    return study;
}

}  // namespace palpate::ui

#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/library/new_protocol.hpp"
#include "ui/cli/commands.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {

int new_command(const NewOptions& options) {
    if (options.keys) {
        say("{}", options.markdown ? protocols::keys_markdown() : protocols::key_reference());
        return 0;
    }
    const std::string id = protocols::id_of(std::filesystem::path(options.file).stem().string());
    write_new(options.file, new_protocol(protocols::shipped_protocol(options.from), id));
    say("{}: a study with the id {}, made from {}\nNext: palpate check {}\n", options.file, id,
        options.from, options.file);
    return 0;
}

}  // namespace palpate::ui

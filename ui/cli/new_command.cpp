#include <filesystem>
#include <string>

#include "engine/base/files.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/library/shipped.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/operator_log.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

struct NewOptions {
    std::string file;                     ///< made; never one that is there
    std::string from = "shape_friction";  ///< a shipped protocol
    bool keys = false;                    ///< only print what a protocol may say
    bool markdown = false;                ///< the keys of all files, as Markdown
};

void declare(CommandWords& words, NewOptions& options) {
    words.add("FILE", options.file, "The file to make; its name becomes the study's id")
        .required_unless("--keys")
        .excludes("--keys");
    words.add("--from", options.from, "The shipped protocol to begin with").excludes("--keys");
    words.add("--keys", options.keys, "Print what a protocol file may say");
    words.add("--markdown", options.markdown, "With --keys: of every kind of file, as Markdown")
        .needs("--keys");
}

int run(const NewOptions& options) {
    if (options.keys) {
        say("{}", options.markdown ? protocols::keys_markdown() : protocols::key_reference());
        return 0;
    }
    const std::string id = protocols::id_of(std::filesystem::path(options.file).stem().string());
    write_new(options.file, new_protocol(protocols::shipped_protocol(options.from), id));
    say("{}: a study with the id {}, made from {}\nNext: palpate check {}\n", options.file, id,
        options.from, shell_word(options.file));
    return 0;
}

}  // namespace

Command new_command() {
    return make_command<NewOptions>(
        "new", "Write a protocol file to begin with: a shipped one with its comments", declare,
        run);
}

}  // namespace palpate::ui

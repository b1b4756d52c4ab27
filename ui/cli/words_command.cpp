#include <memory>

#include "ui/command/command.hpp"
#include "ui/command/word_lists.hpp"
#include "ui/rig/say.hpp"
#include "ui/session/version.hpp"

namespace palpate::ui {

/// @param all  every command, this one too
Command words_command(std::vector<Command> (*all)()) {
    const auto form = std::make_shared<std::string>();
    return {"words", "Print what other programs want to know of the commands",
            [form](CommandWords& words) {
                words.add("FORM", *form, "bash: a script that completes them; man: the manual page")
                    .required()
                    .among({"bash", "man"});
            },
            [form, all] {
                say_to(stdout, *form == "man" ? man_page(all(), kVersion) : bash_completion(all()));
                return 0;
            }};
}

}  // namespace palpate::ui

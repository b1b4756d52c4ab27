#include "data/inference/audit.hpp"
#include "ui/command/command.hpp"
#include "ui/files/analysed_file.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

struct AuditWords : AnswerWords {
    bool json = false;
    double place_mm = 2.0;
    double ratio = 1.1;
    double share = 0.005;
};

void declare(CommandWords& words, AuditWords& options) {
    words.add("FILE", options.file, "A palpate database").required();
    words.add("--json", options.json, "For programs, to standard output");
    add_kind(words, options.kind, "Which sessions: real, pilot or simulated");
    words.add("--study", options.study, "Of a file with several studies, which");
    words.add("--place-mm", options.place_mm, "Start poses that are so near are the same, mm")
        .within(1e-6, 100.0);
    words
        .add("--ratio", options.ratio,
             "Times, strokes, forces and speeds within this ratio are the same")
        .within(1.000001, 10.0);
    words.add("--share", options.share, "Shares of ticks or trials that are so near are the same")
        .within(1e-9, 1.0);
    add_versions(words, options.versions);
}

int run(const AuditWords& words) {
    say("{}", words.asked([&](data::Database& database, const data::AnswerChoice& choice) {
        return (words.json ? data::audit_json : data::audit_text)(
            database, choice,
            {.place_m = 1e-3 * words.place_mm, .ratio = words.ratio, .share = words.share});
    }));
    return 0;
}

}  // namespace

Command audit_command() {
    return make_command<AuditWords>(
        "audit", "Does anything but friction differ between the conditions of friction?", declare,
        run);
}

}  // namespace palpate::ui

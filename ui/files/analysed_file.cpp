#include "ui/files/analysed_file.hpp"

#include <filesystem>
#include <utility>

#include "engine/base/refuse.hpp"
#include "data/store/analysed.hpp"
#include "ui/rig/control_line.hpp"

namespace palpate::ui {

Word& add_kind(CommandWords& words, std::string& kind, std::string help) {
    return words.add("--kind", kind, std::move(help)).among({"real", "pilot", "simulated"});
}

Word& add_versions(CommandWords& words, std::string& versions) {
    return words
        .add("--versions", versions,
             "Versions of a protocol in one file: apart, each a study of its own by its id and "
             "hash, or together, as one")
        .among({"apart", "together"});
}

void add_answer_words(CommandWords& words, AnswerWords& answers) {
    bool& said = answers.of_database;
    add_kind(words, answers.kind, "Of a database, which sessions: real, pilot or simulated")
        .tells(said);
    words.add("--study", answers.study, "Of a database with several studies, which").tells(said);
    words
        .add("--keep-codes", answers.keep_codes,
             "Of a database: people by the lab's codes, not by their numbers in exports")
        .tells(said);
    add_versions(words, answers.versions).tells(said);
}

void AnswerWords::refuse_words_of_databases() const {
    refuse_if(of_database && std::filesystem::exists(file),
              "{} is no database of palpate: --kind, --study, --keep-codes and --versions choose "
              "among a database's answers; leave them out",
              file);
}

void analyse(data::Database& database, const std::string& versions, const std::string& study) {
    warn_of_unblinding(database.file());
    data::analyse(database,
                  versions == "together" ? data::Versions::together : data::Versions::apart, study);
}

}  // namespace palpate::ui

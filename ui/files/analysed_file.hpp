#pragma once

#include <string>

#include "data/analysis/left_out.hpp"
#include "data/store/database.hpp"
#include "ui/command/command.hpp"

namespace palpate::ui {

/// --kind of the sessions meant, and how versions of a protocol are taken.
Word& add_kind(CommandWords& words, std::string& kind, std::string help);
Word& add_versions(CommandWords& words, std::string& versions);

/// From here on the file is seen as analyses see it (data/store/analysed.hpp). Says so where a
/// session runs on it.
/// @param versions  "apart" or "together"
void analyse(data::Database& database, const std::string& versions, const std::string& study = "");

/// Of an analysis of a database or of another lab's file: of a database, which answers it takes.
struct AnswerWords {
    std::string file;
    std::string versions = "apart";
    std::string kind = "real";
    std::string study;
    bool keep_codes = false;
    bool of_database = false;  ///< any of these words is said, and be it the default

    [[nodiscard]] data::AnswerChoice choice() const {
        return {.kind = kind, .study = study, .codes = keep_codes};
    }
    /// @throws std::invalid_argument if the file is there and words of databases are said
    void refuse_words_of_databases() const;
    /// What `read` makes of the file, opened and seen as analyses see it, and of choice().
    template <class Read>
    [[nodiscard]] auto asked(const Read& read) const {
        data::Database database(file, data::Access::read);
        analyse(database, versions, study);
        return read(database, choice());
    }
};
/// All of them but the file: --kind, --study, --keep-codes, --versions.
void add_answer_words(CommandWords& words, AnswerWords& answers);

}  // namespace palpate::ui

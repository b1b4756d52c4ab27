#include "data/export/export.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sys/stat.h>

#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "engine/base/shared_library.hpp"
#include "engine/base/text.hpp"
#include "data/export/csv_export.hpp"
#include "data/export/duckdb.hpp"
#include "data/store/analysed.hpp"
#include "data/store/stored_progress.hpp"

namespace palpate::data {
namespace {

void require_synced(const std::filesystem::path& what) {
    if (!sync_to_disk(what)) {
        throw std::runtime_error(fmt::format("{} could not be written to the disk: {}; is it full?",
                                             what.string(), std::strerror(errno)));
    }
}

/// A folder that is there whole or not at all: filled under another name beside its place, and
/// renamed by keep(). Removed with all that is in it if keep() was not reached.
class NewFolder {
public:
    explicit NewFolder(std::filesystem::path place) : place_(std::move(place)) {
        if (!place_.has_filename()) {  // "here/"
            place_ = place_.parent_path();
        }
        std::error_code unknown;
        refuse_if(place_.empty() ||
                      (std::filesystem::exists(std::filesystem::symlink_status(place_, unknown)) &&
                       !(std::filesystem::is_directory(place_, unknown) &&
                         std::filesystem::is_empty(place_, unknown))),
                  "\"{}\" is there already: give -o the name of a new folder", place_.string());
        remove_leftovers(folder_of(place_));
        std::string name = place_.string() + std::string(kPartName) + "XXXXXX";
        refuse_if<std::runtime_error>(
            mkdtemp(name.data()) == nullptr,
            "cannot make a folder beside {}: is its parent there and writable?", place_.string());
        building_ = name;
        held_.emplace(building_);
    }
    NewFolder(const NewFolder&) = delete;
    NewFolder& operator=(const NewFolder&) = delete;
    ~NewFolder() {
        if (!building_.empty()) {
            std::error_code gone;
            std::filesystem::remove_all(building_, gone);
        }
    }

    /// Where to write until keep().
    [[nodiscard]] const std::filesystem::path& path() const { return building_; }

    /// @param own  nobody but its owner may look inside, nor into files where they are copied to
    void keep(bool own) {
        for (const auto& entry : std::filesystem::recursive_directory_iterator(building_)) {
            if (own) {  // also where it is copied to
                chmod(entry.path().c_str(),
                      S_IRUSR | S_IWUSR | (entry.is_directory() ? S_IXUSR : 0U));
            }
            require_synced(entry.path());
        }
        require_synced(building_);
        if (!own) {
            chmod(building_.c_str(), usual_rights(S_IRWXU | S_IRWXG | S_IRWXO));
        }
        std::error_code failed;
        std::filesystem::rename(building_, place_, failed);
        refuse_if<std::runtime_error>(failed.value() != 0, "cannot rename {} to {}: {}",
                                      building_.string(), place_.string(), failed.message());
        building_.clear();
        static_cast<void>(sync_to_disk(folder_of(place_)));  // some network disks cannot
    }

private:
    std::filesystem::path place_;
    std::filesystem::path building_;
    std::optional<PartLock> held_;
};

namespace fs = std::filesystem;

void convert(DuckDb& duck,
             const std::string& from,
             const fs::path& to,
             std::span<const ExportColumn> kept) {
    constexpr std::string_view kMarked = "'^''(''*[-=+@\t\r])'";
    std::string columns;
    std::string texts;
    for (const ExportColumn& column : kept) {
        const std::string& name = column.name;
        const std::string type = column.type == "integer" ? "BIGINT"
                               : column.type == "real"    ? "DOUBLE"
                                                          : "VARCHAR";
        columns += fmt::format("{}{}: {}", columns.empty() ? "" : ", ", quoted_text(name),
                               quoted_text(type));
        if (type == "VARCHAR") {  // no spreadsheet opens it: the mark of csv_field() goes again
            texts += fmt::format("{}regexp_replace({}, {}, '\\1') AS {}", texts.empty() ? "" : ", ",
                                 quoted_name(name), kMarked, quoted_name(name));
        }
    }
    duck.run(fmt::format(
        "COPY (SELECT *{} FROM read_csv({}, header = true, delim = ',', quote = '\"', escape = "
        "'\"', auto_detect = false, allow_quoted_nulls = false, columns = {{{}}})) TO {} (FORMAT "
        "parquet, COMPRESSION zstd)",
        texts.empty() ? "" : " REPLACE (" + texts + ")", quoted_text(from), columns,
        quoted_text(to.string())));
}

/// A pattern of files could mean more than this folder, whose name is not ours: from inside there
/// are none.
std::string all_ticks(const fs::path& folder) {
    std::string escaped;
    for (const char c : (folder / "ticks").string()) {
        escaped += c == '*' || c == '?' || c == '[' ? fmt::format("[{}]", c) : std::string(1, c);
    }
    return escaped + "/*.csv.gz";
}

/// The tables of export_csv(), zstd; columns.csv and README.txt stay beside them.
void export_parquet(const Exporting& to) {
    const auto& [database, selection, options, folder] = to;
    DuckDb duck;  // before any work
    export_csv(to);
    duck.run("SET preserve_insertion_order = true");
    for (const ExportTable& table : export_tables()) {
        const fs::path from = folder / (std::string(table.name) + ".csv");
        if (!fs::exists(from)) {
            continue;
        }
        convert(duck, from.string(), folder / (std::string(table.name) + ".parquet"),
                visible_columns(table, options.details));
        fs::remove(from);
    }
    if (options.traces) {
        if (!fs::is_empty(folder / "ticks")) {
            convert(duck, all_ticks(folder), folder / "ticks.parquet", tick_columns());
        }
        fs::remove_all(folder / "ticks");
    }
}

/// Every run of a rule as `palpate procedure` reads it: its random numbers follow from the file's
/// secret, and lead back neither to it nor to the participant. Marked answers are left out.
void export_procedures(const Exporting& to) {
    const auto& [database, selection, options, folder] = to;
    int runs = 0;
    Statement row = database.prepare(
        "SELECT DISTINCT run_number FROM adaptive_plan WHERE session_id = ?1 ORDER BY run_number");
    for (const ChosenSession& session : selection.sessions()) {
        row.bind(1, session.id);
        for (; row.step(); ++runs) {
            const ExportedRun made = exported_run(database, session.id, row.integer(0));
            const std::filesystem::path place =
                folder / fmt::format("study-{}_subject-{}_session-{}_run-{}", session.label,
                                     session.subject.substr(4), session.number, row.integer(0));
            std::filesystem::create_directory(place);
            write_whole(place / "CONFIG.toml", made.procedure);
            write_whole(place / "RESPONSES.csv", made.responses);
        }
        row.reset();
    }
    refuse_if(runs == 0,
              "no session of the file has a rule that chooses stimuli: take another format");
    write_whole(folder / "README.txt",
                "A folder a run of a rule: CONFIG.toml is the rule with its random numbers, "
                "RESPONSES.csv what was answered.\n"
                "palpate procedure FOLDER/CONFIG.toml FOLDER/RESPONSES.csv replays it trial by "
                "trial.\n"
                "Marked answers are left out.\n");
}

/// In the order of ExportFormat.
constexpr std::array<void (*)(const Exporting&), kExportWords.size()> kWriters{
    export_csv,        export_bids,     export_psych_ds,  export_parquet,
    export_procedures, export_quickpsy, export_psignifit, export_psychopy};

/// The sessions of which a format has something to write, by session_id; nothing: all.
std::string held_by(ExportFormat format) {
    switch (format) {
        case ExportFormat::procedure:
            return "SELECT session_id FROM adaptive_plan";
        case ExportFormat::quickpsy:
        case ExportFormat::psignifit:
            return fmt::format("SELECT session_id FROM ({})", kGradedAnswers);
        default:
            return {};
    }
}

/// At the end of what a format says of itself.
void add_accounts(const std::filesystem::path& readme,
                  const std::vector<LeftOut>& accounts,
                  const std::vector<NotTaken>& not_taken,
                  bool details) {
    std::string text = file_text(readme) +
                       "\nNothing is here of who does not consent and of withdrawn sessions; whom "
                       "a rule of the protocol leaves out is.\n\n";
    for (const LeftOut& one : accounts) {
        text += left_out_text(details ? one : without_words(one));
    }
    for (const NotTaken& one : not_taken) {
        text += not_taken_text(one);
    }
    write_whole(readme, text);
}

}  // namespace

ExportFormat parse_export_format(std::string_view word) {
    const auto found = std::ranges::find(kExportWords, word);
    refuse_if(found == kExportWords.end(), "\"{}\" is no format: give one of {}", word,
              fmt::join(kExportWords, ", "));
    return static_cast<ExportFormat>(found - kExportWords.begin());
}

std::string not_taken_text(const NotTaken& one) {
    return fmt::format("  Nothing is here of {} of study {}: this format takes no such answers\n",
                       counted(one.sessions, one.kind + " session"), one.study);
}

ExportSummary export_file(const std::string& file,
                          ExportFormat format,
                          const ExportOptions& options,
                          const std::filesystem::path& folder) {
    refuse_if(format >= ExportFormat::procedure &&
                  (options.details || options.traces || options.keep_codes),
              "{} holds no more than answers: details, codes and ticks go with csv, bids, psych-ds "
              "and parquet",
              kExportWords.at(static_cast<std::size_t>(format)));
    Database database(file, Access::read);
    NewFolder built(folder);
    Selection selection(database, options);
    const std::string held = held_by(format);
    std::vector<NotTaken> not_taken = held.empty() ? std::vector<NotTaken>{} : selection.keep(held);
    // The README of BIDS says that there are none.
    refuse_if(options.traces && format != ExportFormat::bids &&
                  !database
                       .prepare("SELECT 1 FROM trace_chunk JOIN trial USING (trial_id) "
                                "JOIN chosen USING (session_id) LIMIT 1")
                       .step(),
              "no session here has ticks, as of palpate simulate --no-traces: export without "
              "--traces");
    kWriters.at(static_cast<std::size_t>(format))({database, selection, options, built.path()});
    analyse(database, Versions::apart);  // from here on without whom analyses do not see
    std::vector<LeftOut> left_out = left_out_everywhere(database, options.kind, false);
    std::erase_if(left_out, [&](const LeftOut& one) {
        return std::ranges::any_of(not_taken, [&](const NotTaken& none) {
            return none.study == one.study && none.kind == one.kind;
        });
    });
    add_accounts(built.path() / (format == ExportFormat::bids       ? "README"
                                 : format == ExportFormat::psych_ds ? "README.md"
                                                                    : "README.txt"),
                 left_out, not_taken, options.details);
    built.keep(options.details || options.keep_codes);
    return {selection.sessions().size(), std::move(left_out), std::move(not_taken)};
}

/// duckdb_result of DuckDB's C API, https://duckdb.org/docs/stable/clients/c/api: six words of its
/// own.
struct DuckDb::Result {
    std::uint64_t own[6] = {};
};

namespace {

SharedLibrary::Symbol needed(const SharedLibrary& library, const char* name) {
    const SharedLibrary::Symbol found = library.find(name);
    refuse_if(found.place == nullptr,
              "what PALPATE_DUCKDB names has no {}: set it to libduckdb.so, version 1", name);
    return found;
}

}  // namespace

DuckDb::DuckDb() {
    const char* named = std::getenv("PALPATE_DUCKDB");
    const std::string name = named != nullptr && *named != '\0' ? named : "libduckdb.so";
    const SharedLibrary library(name);
    refuse_if(!library.loaded(),
              "Parquet needs DuckDB's library, and {} could not be loaded: get libduckdb.so "
              "(duckdb.org; npm install @duckdb/node-bindings-linux-x64 brings one) and set "
              "PALPATE_DUCKDB to its path, or export csv",
              name);
    int (*const open)(const char*, void**) = needed(library, "duckdb_open");
    int (*const connect)(void*, void**) = needed(library, "duckdb_connect");
    query_ = needed(library, "duckdb_query");
    error_ = needed(library, "duckdb_result_error");
    destroy_ = needed(library, "duckdb_destroy_result");
    disconnect_ = needed(library, "duckdb_disconnect");
    close_ = needed(library, "duckdb_close");
    refuse_if<std::runtime_error>(
        open(nullptr, &database_) != 0 || connect(database_, &connection_) != 0,
        "DuckDB could not be opened");
}

DuckDb::~DuckDb() {
    disconnect_(&connection_);
    close_(&database_);
}

void DuckDb::run(const std::string& sql) {
    Result result;
    const bool failed = query_(connection_, sql.c_str(), &result) != 0;
    const char* words = failed ? error_(&result) : nullptr;
    const std::string why = words != nullptr ? words : "";
    destroy_(&result);
    refuse_if<std::runtime_error>(failed, "DuckDB: {}", why);
}

}  // namespace palpate::data

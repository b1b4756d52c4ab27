#include "data/store/database.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/clock.hpp"
#include "engine/base/refuse.hpp"
#include "data/schema/catalogue.hpp"
#include "data/store/disk_space.hpp"
#include "data/store/own_schema.hpp"
#include "data/store/uuid.hpp"

namespace palpate::data {
namespace {

/// SQLite would wait for ever at a pipe, and take a device for an empty database.
/// @throws WrongFile if there is something else than a file under the name of the database, or of
///         the log, index and journal that SQLite keeps beside it
void require_plain_files(const std::string& file) {
    std::error_code unknown;
    const std::filesystem::path there = std::filesystem::canonical(plain_name(file), unknown);
    const std::string name = unknown ? plain_name(file) : there.string();
    for (const char* beside : {"", "-wal", "-shm", "-journal"}) {
        struct stat status {};
        if (stat((name + beside).c_str(), &status) != 0 || S_ISREG(status.st_mode)) {
            continue;
        }
        const mode_t kind = status.st_mode & S_IFMT;
        throw WrongFile(fmt::format(
            "{}{}: this is a {}, no file: {}", file, beside,
            kind == S_IFDIR    ? "folder"
            : kind == S_IFIFO  ? "pipe"
            : kind == S_IFSOCK ? "socket"
                               : "device",
            *beside == '\0' ? "give the name of a file" : "SQLite needs that name, move it away"));
    }
}

[[noreturn]] void not_ours(const std::string& file) {
    throw WrongFile(
        fmt::format("{}: this is not a palpate database; choose another file name", file));
}

/// What the first page says (https://www.sqlite.org/fileformat2.html, 1.3), before SQLite looks at
/// the log or rolls anything back: a database of somebody else's must not be tidied up.
enum class FirstPage : std::uint8_t { blank, ours, theirs };

FirstPage first_page(sqlite3* handle) {
    sqlite3_file* file = nullptr;
    sqlite3_int64 size = 0;
    std::array<unsigned char, 100> head{};
    // Through SQLite's own handle: closing another one would drop the process' locks on the file.
    if (sqlite3_file_control(handle, "main", SQLITE_FCNTL_FILE_POINTER, &file) != SQLITE_OK ||
        file->pMethods->xFileSize(file, &size) != SQLITE_OK || size == 0) {
        return FirstPage::blank;
    }
    constexpr std::string_view kMagic{"SQLite format 3\0", 16};
    if (file->pMethods->xRead(file, head.data(), head.size(), 0) != SQLITE_OK) {
        return FirstPage::theirs;
    }
    // The power went while the tables were made: SQLite's journal will take it back to nothing.
    if (head == decltype(head){} &&
        ::access(sqlite3_filename_journal(sqlite3_db_filename(handle, "main")), F_OK) == 0) {
        return FirstPage::blank;
    }
    if (std::memcmp(head.data(), kMagic.data(), kMagic.size()) != 0) {
        return FirstPage::theirs;
    }
    const auto number = [&head](std::size_t at) {
        return std::int64_t{head[at]} << 24U | head[at + 1] << 16U | head[at + 2] << 8U |
               head[at + 3];
    };
    const std::int64_t pages = number(28);
    const std::int64_t application = number(68);
    if (application == kApplicationId) {
        return FirstPage::ours;
    }
    return application == 0 && pages <= 1 ? FirstPage::blank : FirstPage::theirs;
}

/// Since 1970.
std::int64_t wall_ns() {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    return now.tv_sec * 1'000'000'000 + now.tv_nsec;
}

std::string utc_text(std::int64_t since_1970_ns) {
    const timespec now{.tv_sec = since_1970_ns / 1'000'000'000,
                       .tv_nsec = since_1970_ns % 1'000'000'000};
    tm utc{};
    gmtime_r(&now.tv_sec, &utc);
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", utc.tm_year + 1900,
                       utc.tm_mon + 1, utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec,
                       now.tv_nsec / 1'000'000);
}

}  // namespace

Database::Database(std::string file, Access access)
    : connection_{.file = std::move(file), .failed = fail_with_remedy} {
    try {
        open(access);
    } catch (...) {
        take_back();
        connection_.forget_idle();
        sqlite3_close_v2(connection_.handle);
        throw;
    }
}

Database::~Database() {
    connection_.forget_idle();
    sqlite3_close_v2(connection_.handle);
}

void Database::connect(const std::string& name, int flags) {
    connection_.forget_idle();
    sqlite3_close_v2(std::exchange(connection_.handle, nullptr));
    if (sqlite3_open_v2(name.c_str(), &connection_.handle, flags, nullptr) != SQLITE_OK) {
        fail("opening");
    }
    sqlite3_extended_result_codes(connection_.handle, 1);
    sqlite3_busy_timeout(connection_.handle, wait_ms_);
    // A file can come from anywhere: nothing in it runs, its log stays, until it is known to be
    // ours.
    for (const auto& [option, on] : {std::pair{SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0},
                                     {SQLITE_DBCONFIG_ENABLE_VIEW, 0},
                                     {SQLITE_DBCONFIG_ENABLE_FTS3_TOKENIZER, 0},
                                     {SQLITE_DBCONFIG_ENABLE_TRIGGER, 0},
                                     {SQLITE_DBCONFIG_DEFENSIVE, 1},
                                     {SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1}}) {
        sqlite3_db_config(connection_.handle, option, on, nullptr);
    }
    if ((flags & SQLITE_OPEN_READWRITE) == 0) {  // what is sorted; VACUUM would take the whole file
        execute("PRAGMA temp_store = MEMORY");
    }
}

void Database::open(Access access) {
    if (access == Access::memory) {
        in_memory_ = true;
        connect(":memory:", SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_MEMORY);
        create();
        sqlite3_db_config(connection_.handle, SQLITE_DBCONFIG_ENABLE_VIEW, 1, nullptr);
        execute("PRAGMA foreign_keys = ON");
        return;
    }
    refuse_if<WrongFile>(connection_.file.empty(),
                         "the name of the database is empty; give a file name");
    require_plain_files(connection_.file);
    require_not_elsewhere(connection_.file);
    if (access == Access::write) {
        made_ = made_private(connection_.file);
    } else if (::access(plain_name(connection_.file).c_str(), R_OK) != 0) {
        throw WrongFile(fmt::format("{}: {}", connection_.file,
                                    errno == ENOENT || errno == ENOTDIR
                                        ? "there is no such file: check the path"
                                        : "it may not be read: change its rights"));
    }
    connect(plain_name(connection_.file),
            access == Access::write ? SQLITE_OPEN_READWRITE : SQLITE_OPEN_READONLY);
    // SQLite takes a file of one byte for an empty one, and would write over it.
    struct stat status {};
    const bool one_byte =
        stat(plain_name(connection_.file).c_str(), &status) == 0 && status.st_size == 1;
    if (one_byte || first_page(connection_.handle) == FirstPage::theirs) {
        not_ours(connection_.file);
    }
    require_log(access);
    const std::int64_t as_of_ns = written_ns(connection_.file);  // before it is looked at
    const auto as_it_is = [&] {
        connect(immutable_uri(connection_.file), SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
        connection_.as_of_ns = as_of_ns;
    };
    if (access != Access::write && lies_still(plain_name(connection_.file))) {
        as_it_is();
    }
    refuse_if<StoreError>(
        access == Access::write && sqlite3_db_readonly(connection_.handle, "main") == 1,
        "{}: the file or its folder is read-only: choose another place or change the rights",
        connection_.file);
    require_own_log();
    try {
        check_identity(access);
    } catch (const DiskError&) {
        if (access == Access::write || has_log(plain_name(connection_.file))) {
            throw;
        }
        as_it_is();
        check_identity(access);
    }
    check_schema(access);
    sqlite3_db_config(connection_.handle, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 0, nullptr);
    if (access == Access::write) {
        keep_log();
        execute("PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;");
    }
}

Database::Identity Database::identity() {
    const Snapshot of_one_moment(*this);  // another program may be making the file
    const auto number = [this](std::string_view sql) {
        return first(sql).integer(0);
    };
    Identity id{.application = number("PRAGMA application_id"),
                .version = number("PRAGMA user_version")};
    id.blank =
        id.application == 0 && id.version == 0 && number("SELECT count(*) FROM sqlite_master") == 0;
    return id;
}

void Database::check_identity(Access access) {
    Identity id = identity();
    if (id.blank && access == Access::write) {
        create();
        id = identity();
    }
    refuse_if<WrongFile>(
        id.blank,
        "{}: nothing is in it, as where a program was killed while it made it: run "
        "makes it anew, or take it away",
        connection_.file);
    if (id.application != kApplicationId || id.version < 1) {
        not_ours(connection_.file);
    }
    refuse_if<WrongFile>(id.version != kSchemaVersion,
                         "{}: made by another palpate (schema {}, this program knows {}); use that "
                         "one for it, or choose another file name",
                         connection_.file, id.version, kSchemaVersion);
}

void Database::check_schema(Access access) {
    using Of = SchemaDifference::Of;
    const std::vector<SchemaDifference> found = schema_differences(connection_);
    const auto has = [&found](Of of) {
        return std::ranges::find(found, of, &SchemaDifference::of) != found.end();
    };
    if (access == Access::write && !found.empty()) {
        refuse_schema(connection_, found, "nothing is written into it");
    }
    if (access == Access::read && has(Of::table)) {
        refuse_schema(connection_, found, "what its tables say is not believed");
    }
    if (has(Of::view) || has(Of::table)) {
        make_own_views(connection_);
    } else {
        sqlite3_db_config(connection_.handle, SQLITE_DBCONFIG_ENABLE_VIEW, 1, nullptr);
    }
    if (access != Access::write && !found.empty()) {
        remark_schema(connection_, found);
    }
    if (access == Access::read && ordered_elsewhere(connection_).empty()) {
        require_sound_pages(connection_);
    }
}

void Database::create() {
    Transaction all(*this);  // another program that makes the same file is waited for here
    if (identity().blank) {
        if (sqlite3_exec(connection_.handle, std::string(schema_sql()).c_str(), nullptr, nullptr,
                         nullptr) != SQLITE_OK) {
            fail("making the tables");
        }
        prepare("INSERT INTO secret VALUES (?1)").bind(1, random_secret()).run();
    }
    all.commit();
}

void Database::keep_log() {
    // SQLite does not wait by itself for others that open the file in this moment.
    constexpr int kPauseMs = 5;
    int waited = 0;
    while (sqlite3_exec(connection_.handle, "PRAGMA journal_mode = WAL", nullptr, nullptr,
                        nullptr) != SQLITE_OK) {
        if ((sqlite3_errcode(connection_.handle) & 0xFF) != SQLITE_BUSY || waited >= wait_ms_) {
            fail("switching to a write-ahead log");
        }
        sqlite3_sleep(kPauseMs);
        waited += kPauseMs;
    }
    Statement mode = prepare("PRAGMA journal_mode");
    if (!mode.step() || mode.text(0) != "wal") {  // some network disks: readers would stop the rig
        throw StoreError(fmt::format(
            "{}: this disk cannot keep a write-ahead log; choose a folder on a local disk",
            connection_.file));
    }
}

void Database::wait_for_locks(int ms) {
    wait_ms_ = ms;
    sqlite3_busy_timeout(connection_.handle, ms);
}

std::int64_t Database::last_row() const {
    return sqlite3_last_insert_rowid(connection_.handle);
}

std::int64_t Database::changes() const {
    return sqlite3_changes64(connection_.handle);
}

void Database::checkpoint() {
    if (in_memory_) {
        return;
    }
    rescue_deleted();  // who has another log must not find this one's pages in the file
    sqlite3_busy_timeout(connection_.handle, 0);
    const int code = sqlite3_wal_checkpoint_v2(connection_.handle, nullptr,
                                               SQLITE_CHECKPOINT_TRUNCATE, nullptr, nullptr);
    sqlite3_busy_timeout(connection_.handle, wait_ms_);
    if (code != SQLITE_OK && (code & 0xFF) != SQLITE_BUSY && (code & 0xFF) != SQLITE_LOCKED) {
        fail("moving the log into the file");
    }
    require_in_place();
}

void Database::require_in_place() {
    rescue_deleted();
    int moved = 0;
    sqlite3_file_control(connection_.handle, "main", SQLITE_FCNTL_HAS_MOVED, &moved);
    refuse_if<StoreError>(moved != 0,
                          "{}: it was moved while it was in use; what was recorded is in the file "
                          "wherever it is now: put it back and run again",
                          connection_.file);
}

bool is_database(const std::string& file) {
    constexpr std::string_view kMagic = "SQLite format 3";
    std::array<char, kMagic.size()> start{};
    std::error_code unknown;
    const bool regular = std::filesystem::is_regular_file(file, unknown);  // a pipe is read once
    std::ifstream stream(regular ? file : std::string(), std::ios::binary);
    stream.read(start.data(), start.size());
    return stream && std::string_view(start.data(), start.size()) == kMagic;
}

Transaction::Transaction(Database& database) : database_(&database) {
    database.execute("BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
    if (database_ != nullptr) {
        sqlite3_exec(database_->handle(), "ROLLBACK", nullptr, nullptr, nullptr);
    }
}

void Transaction::commit() {
    database_->execute("COMMIT");
    database_ = nullptr;
}

Snapshot::Snapshot(Database& database) : database_(database) {
    database_.execute("SAVEPOINT snapshot");
}

Snapshot::~Snapshot() {
    sqlite3_exec(database_.handle(), "RELEASE snapshot", nullptr, nullptr, nullptr);
}

std::string utc_now() {
    return utc_text(wall_ns());
}

std::string Database::utc_now(std::int64_t then) const {
    const std::int64_t ago = then == 0 ? 0 : monotonic_ns() - then;
    return utc_text(clock_ ? clock_() : wall_ns() - ago);
}

std::int64_t Database::steady_now(std::int64_t then) const {
    return clock_ ? clock_() : then == 0 ? monotonic_ns() : then;
}

}  // namespace palpate::data

#include "data/sync/postgres.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <memory>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/shared_library.hpp"
#include "data/export/csv_export.hpp"

namespace palpate::data {
namespace {

using Oid = unsigned;
constexpr Oid kBytea = 17;

// Of libpq-fe.h; values of its enumerations never change.
struct PGconn;
struct PGresult;
constexpr int kConnectionOk = 0;
constexpr int kCommandOk = 1;
constexpr int kTuplesOk = 2;
constexpr int kPipelineSync = 10;
constexpr int kPipelineAborted = 11;

/// libpq, PostgreSQL's C library (https://www.postgresql.org/docs/current/libpq.html), loaded when
/// the first server is asked for: it brings twenty libraries, and no other command needs one of
/// them.
class Libpq {
public:
    /// @throws std::invalid_argument if it is not installed: what to install
    [[nodiscard]] static const Libpq& get() {
        static const Libpq libpq;
        return libpq;
    }

private:
    SharedLibrary library_{"libpq.so.5"};

    [[nodiscard]] SharedLibrary::Symbol needed(const char* name) const {
        const SharedLibrary::Symbol found = library_.find(name);
        refuse_if(found.place == nullptr,
                  "palpate push needs PostgreSQL's library, libpq.so.5 of version 14 or later: "
                  "install libpq5, and push again");
        return found;
    }

public:
    void (*clear)(PGresult*) = needed("PQclear");
    char* (*cmd_tuples)(PGresult*) = needed("PQcmdTuples");
    PGconn* (*connect)(const char*) = needed("PQconnectdb");
    void* (*conninfo)(PGconn*) = needed("PQconninfo");
    PGconn* (*connect_start)(const char*) = needed("PQconnectStart");
    int (*ssl_in_use)(PGconn*) = needed("PQsslInUse");
    const char* (*ssl_attribute)(PGconn*, const char*) = needed("PQsslAttribute");
    void (*conninfo_free)(void*) = needed("PQconninfoFree");
    void* (*conninfo_parse)(const char*, char**) = needed("PQconninfoParse");
    int (*enter_pipeline_mode)(PGconn*) = needed("PQenterPipelineMode");
    char* (*error_message)(const PGconn*) = needed("PQerrorMessage");
    PGresult* (*exec)(PGconn*, const char*) = needed("PQexec");
    PGresult* (*exec_params)(
        PGconn*, const char*, int, const Oid*, const char* const*, const int*, const int*, int) =
        needed("PQexecParams");
    int (*exit_pipeline_mode)(PGconn*) = needed("PQexitPipelineMode");
    void (*finish)(PGconn*) = needed("PQfinish");
    PGresult* (*get_result)(PGconn*) = needed("PQgetResult");
    int (*is_null)(const PGresult*, int, int) = needed("PQgetisnull");
    char* (*value)(const PGresult*, int, int) = needed("PQgetvalue");
    char* (*host)(const PGconn*) = needed("PQhost");
    int (*columns)(const PGresult*) = needed("PQnfields");
    int (*rows)(const PGresult*) = needed("PQntuples");
    char* (*password)(const PGconn*) = needed("PQpass");
    int (*pipeline_sync)(PGconn*) = needed("PQpipelineSync");
    char* (*result_error_message)(const PGresult*) = needed("PQresultErrorMessage");
    int (*result_status)(const PGresult*) = needed("PQresultStatus");
    int (*send_query_params)(
        PGconn*, const char*, int, const Oid*, const char* const*, const int*, const int*, int) =
        needed("PQsendQueryParams");
    void* (*set_notice_processor)(PGconn*,
                                  void (*)(void*, const char*),
                                  void*) = needed("PQsetNoticeProcessor");
    int (*status)(const PGconn*) = needed("PQstatus");
};

const Libpq& pq() {
    return Libpq::get();
}
PGconn* of(void* connection) {
    return static_cast<PGconn*>(connection);
}

class Result {
public:
    explicit Result(PGresult* result) : result_(result) {}
    Result(const Result&) = delete;
    Result& operator=(const Result&) = delete;
    ~Result() { pq().clear(result_); }
    [[nodiscard]] PGresult* get() const { return result_; }
    [[nodiscard]] bool good() const {
        const int status = pq().result_status(result_);
        return status == kCommandOk || status == kTuplesOk;
    }

private:
    PGresult* result_;
};

struct ConninfoOption {
    const char *keyword, *variable, *compiled, *value, *label, *shown;
    int size;
};

/// A word of the connection as libpq has it: from the URL, a service file, a variable, or by
/// itself.
std::string word_of(PGconn* connection, std::string_view keyword) {
    auto* all = static_cast<ConninfoOption*>(pq().conninfo(connection));
    std::string value;
    for (const ConninfoOption* one = all; one != nullptr && one->keyword != nullptr; ++one) {
        if (one->keyword == keyword && one->value != nullptr) {
            value = one->value;
        }
    }
    pq().conninfo_free(all);
    return value;
}

/// This machine: a socket, or an address that goes no further.
bool stays_here(std::string_view host) {
    constexpr std::string_view kName = "localhost";  // in any letters
    return host.empty() || host.front() == '/' || host.front() == '@' ||
           std::ranges::equal(host, kName, {}, [](unsigned char c) { return std::tolower(c); }) ||
           host == "::1" ||
           (host.starts_with("127.") &&
            host.find_first_not_of("0123456789.") == std::string_view::npos);
}

/// The places of a list with commas, one at least.
std::vector<std::string> list_of(const std::string& words) {
    std::vector<std::string> all(1);
    for (const char c : words) {
        if (c == ',') {
            all.emplace_back();
        } else {
            all.back() += c;
        }
    }
    return all;
}

/// Looked at before a word is sent: of several hosts each.
void require_secure(PGconn* connection) {
    const auto addresses = list_of(word_of(connection, "hostaddr"));
    const auto hosts = list_of(word_of(connection, "host"));
    const std::string mode = word_of(connection, "sslmode");
    for (std::size_t i = 0; i < std::max(addresses.size(), hosts.size()); ++i) {
        // libpq goes by an address, and where its place is empty by the host's name.
        const bool by_name = i >= addresses.size() || addresses[i].empty();
        const std::string host = !by_name ? addresses[i] : i < hosts.size() ? hosts[i] : "";
        refuse_if(
            !stays_here(host) && mode != "verify-full",
            "{} is another machine, and with sslmode={} others can read what is sent, or answer in "
            "its place: give sslmode=verify-full with sslrootcert, or --insecure as well",
            host, mode);
    }
}

/// What libpq asks for, as long as the row lives.
struct Parameters {
    std::vector<const char*> values;
    std::vector<int> lengths, formats;
    std::vector<Oid> types;
};

/// A wrong URL is not repeated, by libpq neither: its words could hold the password.
void require_url(const std::string& url) {
    const bool ours = url.starts_with("postgresql://") || url.starts_with("postgres://");
    void* parsed = ours ? pq().conninfo_parse(url.c_str(), nullptr) : nullptr;
    const bool good = parsed != nullptr;
    pq().conninfo_free(parsed);
    refuse_if(!good,
              "--to is no URL of a PostgreSQL server: give postgresql://USER@HOST/DATABASE, signs "
              "other than letters and digits as %XX");
}

template <class Values>
Parameters parameters_of(const Values& values) {
    Parameters all;
    for (const auto& value : values) {
        all.values.push_back(value.null ? nullptr : value.bytes.data());
        all.lengths.push_back(static_cast<int>(value.bytes.size()));
        all.formats.push_back(value.binary ? 1 : 0);
        all.types.push_back(value.binary ? kBytea : 0);
    }
    return all;
}

}  // namespace

PostgresRow& PostgresRow::none() {
    values_.push_back({{}, false, true});
    return *this;
}
PostgresRow& PostgresRow::text(std::string_view value) {
    values_.push_back({std::string(value), false, false});
    return *this;
}
PostgresRow& PostgresRow::integer(std::int64_t value) {
    return text(fmt::format("{}", value));
}
PostgresRow& PostgresRow::real(double value) {
    return text(number_text(value));
}
PostgresRow& PostgresRow::bytes(std::span<const std::byte> value) {
    values_.push_back(
        {std::string(reinterpret_cast<const char*>(value.data()), value.size()), true, false});
    return *this;
}

Postgres::Postgres(const std::string& url, bool insecure) {
    require_url(url);
    if (!insecure) {
        const std::unique_ptr<PGconn, decltype(Libpq::finish)> begun(
            pq().connect_start(url.c_str()), pq().finish);
        require_secure(begun.get());
    }
    connection_ = pq().connect(url.c_str());
    if (pq().status(of(connection_)) != kConnectionOk) {
        try {
            fail("connecting", pq().error_message(of(connection_)));
        } catch (...) {
            pq().finish(of(connection_));
            throw;
        }
    }
    // What the server remarks would go to standard error as it comes; what fails is thrown.
    pq().set_notice_processor(
        of(connection_), [](void*, const char*) {}, nullptr);
    run("SET client_min_messages = warning; SET client_encoding = 'UTF8'");
}

std::string Postgres::way() const {
    PGconn* connection = of(connection_);
    const char* host = pq().host(connection);
    std::string text = host == nullptr || *host == '\0' ? "?" : host;
    if (pq().ssl_in_use(connection) == 0) {
        return text + ", not encrypted by TLS";
    }
    const char* version = pq().ssl_attribute(connection, "protocol");
    return fmt::format("{}, over {}, the server {}", text, version == nullptr ? "TLS" : version,
                       word_of(connection, "sslmode") == "verify-full" ? "checked" : "not checked");
}

Postgres::~Postgres() {
    pq().finish(of(connection_));
}

void Postgres::fail(std::string_view doing, const char* words) const {
    std::string said = words;
    const char* password = pq().password(of(connection_));
    for (std::size_t at = 0; password != nullptr && *password != '\0' &&
                             (at = said.find(password)) != std::string::npos;) {
        said.replace(at, std::strlen(password), "...");
        if (std::strstr("...", password) != nullptr) {
            break;
        }
    }
    while (!said.empty() && said.back() == '\n') {
        said.pop_back();
    }
    for (std::size_t at = 0; (at = said.find_first_of("\n\t", at)) != std::string::npos;) {
        const std::size_t end = std::min(said.find_first_not_of("\n\t", at), said.size());
        said.replace(at, end - at, "; ");
    }
    const char* host = pq().host(of(connection_));
    throw PostgresError(fmt::format("PostgreSQL at {}: {} failed: {}",
                                    host == nullptr || *host == '\0' ? "?" : host, doing, said));
}

void Postgres::run(const std::string& sql) {
    const Result result(pq().exec(of(connection_), sql.c_str()));
    if (!result.good()) {
        fail("a statement", pq().error_message(of(connection_)));
    }
}

std::vector<std::vector<std::optional<std::string>>> Postgres::rows(const std::string& sql,
                                                                    const PostgresRow& row) {
    const Parameters all = parameters_of(row.values_);
    const Result result(pq().exec_params(
        of(connection_), sql.c_str(), static_cast<int>(all.values.size()), all.types.data(),
        all.values.data(), all.lengths.data(), all.formats.data(), 0));
    if (!result.good()) {
        fail("a query", pq().error_message(of(connection_)));
    }
    std::vector<std::vector<std::optional<std::string>>> found;
    for (int line = 0; line < pq().rows(result.get()); ++line) {
        auto& values = found.emplace_back();
        for (int column = 0; column < pq().columns(result.get()); ++column) {
            const bool null = pq().is_null(result.get(), line, column) != 0;
            values.push_back(
                null ? std::nullopt
                     : std::optional<std::string>(pq().value(result.get(), line, column)));
        }
    }
    return found;
}

void Postgres::send(const std::string& sql, const PostgresRow& row) {
    const Parameters all = parameters_of(row.values_);
    if ((waiting_ == 0 && pq().enter_pipeline_mode(of(connection_)) == 0) ||
        pq().send_query_params(of(connection_), sql.c_str(), static_cast<int>(all.values.size()),
                               all.types.data(), all.values.data(), all.lengths.data(),
                               all.formats.data(), 0) == 0) {
        fail("sending rows", pq().error_message(of(connection_)));
    }
    ++waiting_;
}

std::int64_t Postgres::flush() {
    if (waiting_ == 0) {
        return 0;
    }
    // Without BEGIN, all statements up to a sync are one transaction.
    if (pq().pipeline_sync(of(connection_)) == 0) {
        fail("sending rows", pq().error_message(of(connection_)));
    }
    std::int64_t added = 0;
    std::string wrong;
    bool ended = false;
    for (bool synced = false; !synced;) {
        PGresult* next = pq().get_result(of(connection_));
        if (next == nullptr) {
            // The end of a statement's results. Twice in a row nothing is left to wait for, and the
            // sync did not come: the server is gone, whatever PQstatus says.
            if (ended || pq().status(of(connection_)) != kConnectionOk) {
                fail("sending rows",
                     wrong.empty() ? pq().error_message(of(connection_)) : wrong.c_str());
            }
            ended = true;
            continue;
        }
        ended = false;
        const Result result(next);
        const int status = pq().result_status(next);
        synced = status == kPipelineSync;
        if (status == kCommandOk) {
            added += std::atoll(pq().cmd_tuples(next));
        } else if (!synced && status != kTuplesOk && status != kPipelineAborted && wrong.empty()) {
            wrong = pq().result_error_message(next);
        }
    }
    waiting_ = 0;
    pq().exit_pipeline_mode(of(connection_));
    if (!wrong.empty()) {
        fail("adding rows", wrong.c_str());
    }
    return added;
}

}  // namespace palpate::data

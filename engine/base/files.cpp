#include "engine/base/files.hpp"

#include <cerrno>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/refuse.hpp"

namespace palpate {
bool sync_to_disk(const std::filesystem::path& what) {
    const int fd = open(what.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) {
        return false;
    }
    const int error = fsync(fd) == 0 ? 0 : errno;
    close(fd);
    errno = error;
    return error == 0;
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
    const std::filesystem::path parent = file.parent_path();
    return parent.empty() ? "." : parent;
}

namespace {

[[noreturn]] void fail(const std::string& file, int error) {
    throw std::runtime_error(fmt::format(
        "{}: cannot be written: {}; check the folder, its rights and the space on the disk", file,
        std::generic_category().message(error)));
}

/// All of it, or errno.
int write_all(int fd, std::string_view text) {
    while (!text.empty()) {
        const ssize_t n = ::write(fd, text.data(), text.size());
        if (n < 0 && errno != EINTR) {
            return errno;
        }
        text.remove_prefix(n > 0 ? static_cast<std::size_t>(n) : 0);
    }
    return 0;
}

/// Beside a file that is made whole there; a pipe or a terminal is written itself.
struct Part {
    explicit Part(const std::filesystem::path& file, Rights rights = Rights::usual) {
        struct stat there {};
        special = ::stat(file.c_str(), &there) == 0 && !S_ISREG(there.st_mode);
        if (special) {  // a pipe that nobody reads is an error, not a long wait
            name = file.string();
            fd = ::open(name.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
        } else {  // new: nobody can guess the name, and so lay a link there
            name = file.string() + std::string(kPartName) + "XXXXXX";
            fd = ::mkostemp(name.data(), O_CLOEXEC);
        }
        if (fd < 0) {
            fail(file.string(), errno);
        }
        if (!special) {
            ::flock(fd, LOCK_EX | LOCK_NB);
            constexpr mode_t kEverybody = 0666;
            if (rights == Rights::usual) {
                static_cast<void>(::fchmod(fd, usual_rights(kEverybody)));
            }
        }
    }
    bool special = false;
    std::string name;
    int fd = -1;
};

/// "NAME.palpate-part-aB3dE6"
bool is_part(std::string_view name) {
    constexpr std::size_t kLetters = 6;
    const std::size_t at = name.rfind(kPartName);
    return at != std::string_view::npos && at > 0 &&
           name.size() == at + kPartName.size() + kLetters;
}

/// How every text of this one's kind begins.
std::string_view beginning_of(std::string_view text) {
    std::size_t end = text.starts_with('<') ? text.find_first_of(" >\n") : text.find('\n');
    if (text.starts_with("format = ")) {  // so begins every TOML of ours: its first table as well
        for (int line = 1; line < 3 && end != std::string_view::npos; ++line) {
            end = text.find('\n', end + 1);
        }
    }
    return text.substr(0, end);
}

void require_own_kind(const std::filesystem::path& file, std::string_view text) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error) ||
        std::filesystem::file_size(file, error) == 0) {
        return;
    }
    const std::string_view wanted = beginning_of(text);
    std::string there(wanted.size() + 1, '\0');
    std::ifstream in(file, std::ios::binary);
    in.read(there.data(), static_cast<std::streamsize>(there.size()));
    there.resize(static_cast<std::size_t>(in.gcount()));
    // "t_s,x" is not the head "t_s,x_m"; a tag that is asked for alone has no end to compare.
    const bool ends = there.size() <= wanted.size() || wanted.size() == text.size() ||
                      there[wanted.size()] == text[wanted.size()];
    refuse_if(text.empty() || !there.starts_with(wanted) || !ends,
              "{} is there already and is not what this command writes: it stays as it is; give "
              "another name",
              file.string());
}

}  // namespace

mode_t usual_rights(mode_t wanted) {
    const mode_t mask = ::umask(0);
    ::umask(mask);
    return wanted & ~mask;
}

PartLock::PartLock(const std::filesystem::path& part)
    : part_(::open(part.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC)) {
    // Some network disks cannot: then nothing is removed either.
    ::flock(part_.get(), LOCK_EX | LOCK_NB);
}

void remove_leftovers(const std::filesystem::path& folder) {
    std::error_code unknown;
    for (const auto& entry : std::filesystem::directory_iterator(folder, unknown)) {
        if (!is_part(entry.path().filename().string())) {
            continue;
        }
        const int fd = ::open(entry.path().c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
        struct stat there {};
        const bool left = fd >= 0 && ::fstat(fd, &there) == 0 && there.st_uid == ::geteuid() &&
                          (S_ISREG(there.st_mode) || S_ISDIR(there.st_mode)) &&
                          ::flock(fd, LOCK_EX | LOCK_NB) == 0;
        if (left) {
            std::error_code failed;
            std::filesystem::remove_all(entry.path(), failed);
            remark(fmt::format("{}: a palpate that was killed left it half made; {}",
                               entry.path().string(),
                               failed ? "it cannot be removed: " + failed.message()
                                      : std::string("it is removed")));
        }
        ::close(fd);
    }
}

std::string first_line(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    return line;
}

std::string file_text(const std::filesystem::path& file) {
    const std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();  // of what vanishes meanwhile, as in /proc, nothing is thrown
    return std::move(text).str();
}

void require_writable(const std::filesystem::path& file, std::string_view text) {
    if (file.empty()) {
        return;
    }
    require_own_kind(file, text);
    remove_leftovers(folder_of(file));
    const Part part(file);
    ::close(part.fd);
    if (!part.special) {
        ::unlink(part.name.c_str());
    }
}

void write_whole(const std::filesystem::path& file, std::string_view text, Rights rights) {
    WholeText whole(file, text, rights);
    whole.add(text);
    whole.finish();
}

WholeText::WholeText(const std::filesystem::path& file, std::string_view head, Rights rights)
    : file_(file) {
    if (file.empty()) {
        std::fflush(stdout);
        fd_ = STDOUT_FILENO;
        return;
    }
    require_own_kind(file, head);
    const Part part(file, rights);
    fd_ = part.fd;
    part_ = part.special ? "" : part.name;
    ::fcntl(fd_, F_SETFL, O_WRONLY);
}

WholeText::~WholeText() {
    if (fd_ >= 0 && fd_ != STDOUT_FILENO) {
        ::close(fd_);
    }
    if (!part_.empty()) {
        ::unlink(part_.c_str());
    }
}

void WholeText::add(std::string_view text) {
    if (const int error = write_all(fd_, text)) {
        fail(file_.empty() ? "standard output" : file_.string(), error);
    }
}

void WholeText::finish() {
    if (file_.empty()) {
        return;
    }
    int error = !part_.empty() && ::fsync(fd_) != 0 ? errno : 0;
    ::close(std::exchange(fd_, -1));
    if (error == 0 && !part_.empty() && std::rename(part_.c_str(), file_.c_str()) != 0) {
        error = errno;
    }
    if (error != 0) {
        fail(file_.string(), error);
    }
    if (!part_.empty()) {
        part_.clear();
        static_cast<void>(sync_to_disk(folder_of(file_)));  // some network disks cannot
    }
}

void write_new(const std::filesystem::path& file, std::string_view text, Rights rights) {
    const mode_t mode = rights == Rights::own ? 0600 : 0666;
    const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    int error = fd < 0 ? errno : 0;
    refuse_if(error == EEXIST, "{} is there already, and stays as it is: give another name",
              file.string());
    refuse_if(fd < 0, "{} cannot be written: {}; check the path", file.string(),
              std::generic_category().message(error));
    error = write_all(fd, text);
    if (error == 0 && ::fsync(fd) != 0) {
        error = errno;
    }
    ::close(fd);
    if (error != 0) {
        ::unlink(file.c_str());
        fail(file.string(), error);
    }
    static_cast<void>(sync_to_disk(folder_of(file)));  // some network disks cannot
}

void make_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    refuse_if(error.value() != 0, "{}: this folder cannot be made: {}; give another name",
              folder.string(), error.message());
}

}  // namespace palpate

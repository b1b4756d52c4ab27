/* Preloaded: whoever asks for the wall clock hears another day each time. Other clocks go on as they are. */
#include <stdatomic.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static atomic_int asked;

int clock_gettime(clockid_t clock, struct timespec* now) {
    const int failed = (int)syscall(SYS_clock_gettime, clock, now);
    if (failed == 0 && clock == CLOCK_REALTIME) {
        now->tv_sec += ((atomic_fetch_add(&asked, 1) * 7) % 5 - 2) * 86400L;
    }
    return failed;
}

int gettimeofday(struct timeval* now, void* zone) {
    (void)zone;
    struct timespec time;
    const int failed = clock_gettime(CLOCK_REALTIME, &time);
    now->tv_sec = time.tv_sec;
    now->tv_usec = time.tv_nsec / 1000;
    return failed;
}

time_t time(time_t* now) {
    struct timespec time;
    clock_gettime(CLOCK_REALTIME, &time);
    if (now != 0) {
        *now = time.tv_sec;
    }
    return time.tv_sec;
}

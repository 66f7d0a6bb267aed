// SPDX-License-Identifier: BSD-3-Clause
#include "tests/rt/realtime/watched_section.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <semaphore.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>

namespace {

// In the thread's static TLS block: reading it allocates nothing.
#define WATCH_TLS __attribute__((tls_model("initial-exec"))) thread_local
WATCH_TLS bool watching = false;
WATCH_TLS bool filtered = false;
WATCH_TLS int allocations = 0, frees = 0, locks = 0, system_calls = 0;
WATCH_TLS long last_system_call = -1;
WATCH_TLS long faults_before = 0;

bool filter_works = true;

template <typename F>
F next_of(const char* name) {
  return reinterpret_cast<F>(dlsym(RTLD_NEXT, name));
}

// Looked up before main: dlsym itself allocates and locks.
using MutexFunction = int (*)(pthread_mutex_t*);
using CondFunction = int (*)(pthread_cond_t*);
using SemFunction = int (*)(sem_t*);
MutexFunction next_mutex_lock;
CondFunction next_cond_signal, next_cond_broadcast;
SemFunction next_sem_post, next_sem_wait;

__attribute__((constructor)) void find_next() {
  next_mutex_lock = next_of<MutexFunction>("pthread_mutex_lock");
  next_cond_signal = next_of<CondFunction>("pthread_cond_signal");
  next_cond_broadcast = next_of<CondFunction>("pthread_cond_broadcast");
  next_sem_post = next_of<SemFunction>("sem_post");
  next_sem_wait = next_of<SemFunction>("sem_wait");
}

long faults_now() {
  rusage usage;
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

}  // namespace

extern "C" {
// glibc's names. NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)

void* malloc(std::size_t size) {
  allocations += watching;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  allocations += watching;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  allocations += watching;
  return __libc_realloc(old, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  allocations += watching;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  allocations += watching;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  allocations += watching;
  *out = __libc_memalign(alignment, size);
  return *out ? 0 : 12;
}
void free(void* p) {
  frees += watching && p != nullptr;
  __libc_free(p);
}
int pthread_mutex_lock(pthread_mutex_t* mutex) {
  locks += watching;
  static const auto fallback = next_of<MutexFunction>("pthread_mutex_lock");
  return next_mutex_lock ? next_mutex_lock(mutex) : fallback(mutex);
}
int pthread_cond_signal(pthread_cond_t* condition) {
  locks += watching;
  return next_cond_signal(condition);
}
int pthread_cond_broadcast(pthread_cond_t* condition) {
  locks += watching;
  return next_cond_broadcast(condition);
}
int sem_post(sem_t* semaphore) {
  locks += watching;
  return next_sem_post(semaphore);
}
int sem_wait(sem_t* semaphore) {
  locks += watching;
  return next_sem_wait(semaphore);
}

// The one place from which the filter lets every call through: the handler repeats there what it
// has counted.
long watched_raw_system_call(long number, long a, long b, long c, long d, long e, long f);
extern const char watched_raw_system_call_return[];
#ifdef __aarch64__
asm(R"(
.text
.globl watched_raw_system_call
watched_raw_system_call:
  mov x8, x0
  mov x0, x1
  mov x1, x2
  mov x2, x3
  mov x3, x4
  mov x4, x5
  mov x5, x6
  svc #0
.globl watched_raw_system_call_return
watched_raw_system_call_return:
  ret
)");
#else
asm(R"(
.text
.globl watched_raw_system_call
watched_raw_system_call:
  mov %rdi, %rax
  mov %rsi, %rdi
  mov %rdx, %rsi
  mov %rcx, %rdx
  mov %r8, %r10
  mov %r9, %r8
  mov 8(%rsp), %r9
  syscall
.globl watched_raw_system_call_return
watched_raw_system_call_return:
  ret
)");
#endif
}

namespace sandrunner {
namespace {

void on_system_call(int, siginfo_t* info, void* context) {
  if (watching) {
    ++system_calls;
    last_system_call = info->si_syscall;
  }
#ifdef __aarch64__
  auto* const r = static_cast<ucontext_t*>(context)->uc_mcontext.regs;
  const auto argument = [&](int i) { return static_cast<long>(r[i]); };
  r[0] = static_cast<std::uint64_t>(watched_raw_system_call(info->si_syscall, argument(0),
                                                            argument(1), argument(2), argument(3),
                                                            argument(4), argument(5)));
#else
  greg_t* const r = static_cast<ucontext_t*>(context)->uc_mcontext.gregs;
  r[REG_RAX] = watched_raw_system_call(info->si_syscall, r[REG_RDI], r[REG_RSI], r[REG_RDX],
                                       r[REG_R10], r[REG_R8], r[REG_R9]);
#endif
}

bool install_filter() {
  struct sigaction action = {};
  action.sa_sigaction = on_system_call;
  action.sa_flags = SA_SIGINFO | SA_NODEFER;
  sigaction(SIGSYS, &action, nullptr);
  const auto allowed = reinterpret_cast<std::uintptr_t>(watched_raw_system_call_return);
  constexpr auto kIp = offsetof(seccomp_data, instruction_pointer);
  sock_filter filter[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_clock_nanosleep, 6, 0),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_rt_sigreturn, 5, 0),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kIp),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(allowed), 0, 2),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kIp + 4),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(allowed >> 32), 1, 0),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  };
  const sock_fprog program{.len = sizeof filter / sizeof filter[0], .filter = filter};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

}  // namespace

std::string WatchedDeeds::text() const {
  return fmt::format(
      "{} allocations, {} frees, {} locks, {} system calls (last {}), {} page faults", allocations,
      frees, locks, system_calls, last_system_call, page_faults);
}

void begin_watch() noexcept {
  if (!filtered) filter_works = install_filter() && filter_works;
  filtered = true;
  allocations = frees = locks = system_calls = 0;
  last_system_call = -1;
  faults_before = faults_now();
  watching = true;
}

WatchedDeeds end_watch() noexcept {
  watching = false;
  WatchedDeeds deeds;
  deeds.page_faults = faults_now() - faults_before;
  deeds.allocations = allocations;
  deeds.frees = frees;
  deeds.locks = locks;
  deeds.system_calls = system_calls;
  deeds.last_system_call = last_system_call;
  return deeds;
}

bool can_filter_system_calls() noexcept { return filter_works; }

}  // namespace sandrunner

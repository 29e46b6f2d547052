/* Lets one system call of a program and its descendants fail, or never return.
 *
 *     inject REPORT CALLS NUMBER ERROR PROGRAM [ARGUMENT...]
 *
 * CALLS: names separated by commas. NUMBER: which of these calls of all processes fails, from 1; 0 for none. ERROR:
 * number of the error, 0 for a call that never returns, or -1 to kill the program (not its descendants) before the call. Writes the number of calls, and the name of the process
 * whose call failed, to the file REPORT. Exits with the code of the program (128 + number of a signal).
 *
 * A seccomp filter reports each of these calls to this program (Linux 5.8), which answers "continue" or the error. */
#define _GNU_SOURCE
#include <errno.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

static const struct {
    const char *name;
    int number;
} CALLS[] = {
#ifdef SYS_rename
    {"rename", SYS_rename},
#endif
#ifdef SYS_unlink
    {"unlink", SYS_unlink},       {"rmdir", SYS_rmdir},
#endif
    {"statx", SYS_statx},         {"linkat", SYS_linkat}, {"unlinkat", SYS_unlinkat}, {"getdents64", SYS_getdents64},
    {"openat", SYS_openat},       {"flock", SYS_flock}, {"write", SYS_write},   {"renameat", SYS_renameat},
    {"renameat2", SYS_renameat2}, {"mmap", SYS_mmap},   {"execve", SYS_execve}, {"ftruncate", SYS_ftruncate},
};

/* Installs the filter in this process; returns the descriptor of its reports. */
static int install(char *names) {
    struct sock_filter filter[2 * sizeof CALLS / sizeof *CALLS + 2];
    unsigned short length = 0;
    filter[length++] = (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr));
    for (char *name = strtok(names, ","); name; name = strtok(NULL, ","))
        for (size_t i = 0; i < sizeof CALLS / sizeof *CALLS; i++)
            if (!strcmp(CALLS[i].name, name)) {
                filter[length++] = (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, CALLS[i].number, 0, 1);
                filter[length++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_USER_NOTIF);
            }
    filter[length++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
    struct sock_fprog program = {length, filter};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0))
        return -1;
    return syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_NEW_LISTENER, &program);
}

/* Writes the name of a process. */
static void write_name(FILE *report, int pid) {
    char path[64], name[64] = "?";
    snprintf(path, sizeof path, "/proc/%d/comm", pid);
    FILE *comm = fopen(path, "r");
    if (comm && fgets(name, sizeof name, comm))
        name[strcspn(name, "\n")] = 0;
    if (comm)
        fclose(comm);
    fprintf(report, "%s\n", name);
}

int main(int count, char **words) {
    if (count < 6)
        return 125;
    FILE *report = fopen(words[1], "w");
    long wanted = atol(words[3]), calls = 0;
    int error = atoi(words[4]);
    /* Shared with the child, which cannot report the descriptor by a call that may be filtered. */
    volatile int *listener = mmap(NULL, sizeof *listener, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (!report || listener == MAP_FAILED)
        return 125;
    /* The child shares the descriptors until it executes the program. */
    int child = syscall(SYS_clone, CLONE_FILES | SIGCHLD, NULL, NULL, NULL, NULL);
    if (child == 0) {
        unsetenv("LD_LIBRARY_PATH"); /* Cargo sets it; the loader would search there with more calls. */
        *listener = install(words[2]);
        if (*listener > 0)
            execvp(words[5], words + 5);
        _exit(125);
    }
    int status = 0, ended = child < 0;
    while (!*listener && !ended)
        ended = waitpid(child, &status, WNOHANG) != 0;
    for (;;) {
        /* It hangs up once no process has the filter. */
        struct pollfd reports = {*listener, POLLIN, 0};
        poll(&reports, 1, 1000);
        if (!ended)
            ended = waitpid(child, &status, WNOHANG) != 0;
        if (*listener < 0 || reports.revents & (POLLHUP | POLLERR | POLLNVAL))
            break;
        struct seccomp_notif call = {0};
        if (!(reports.revents & POLLIN) || ioctl(*listener, SECCOMP_IOCTL_NOTIF_RECV, &call))
            continue;
        int fails = ++calls == wanted;
        if (fails)
            write_name(report, call.pid);
        struct seccomp_notif_resp answer = {call.id, 0, fails ? -error : 0, fails ? 0 : SECCOMP_USER_NOTIF_FLAG_CONTINUE};
        if (fails && error < 0) {
            fflush(report);
            kill(child, SIGKILL);
            continue;
        }
        if (fails && !error) {
            fflush(report);
            continue;
        }
        ioctl(*listener, SECCOMP_IOCTL_NOTIF_SEND, &answer);
    }
    if (!ended)
        waitpid(child, &status, 0);
    fprintf(report, "%ld\n", calls);
    fclose(report);
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

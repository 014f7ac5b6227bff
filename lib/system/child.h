/* child.h - untrusted work in a child process with limits on time and memory.
 *
 * The child writes its reply into a pipe and ends; the parent collects the reply and always reaps
 * the child, whatever it does. Safe while other threads run: the child uses none of them. */
#ifndef SM_CHILD_H
#define SM_CHILD_H

#include <stdbool.h>
#include <stddef.h>

/* Sanitizers map terabytes of shadow memory, which no limit on the address space survives. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SM_CHILD_LIMITS_MEMORY 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) ||                         \
    __has_feature(memory_sanitizer)
#define SM_CHILD_LIMITS_MEMORY 0
#endif
#endif
#ifndef SM_CHILD_LIMITS_MEMORY
#define SM_CHILD_LIMITS_MEMORY 1
#endif

typedef struct {
    double seconds;   /* wall clock */
    double megabytes; /* address space beyond the parent's own (not where
                         SM_CHILD_LIMITS_MEMORY is 0), and the reply's size */
} SmChildLimits;

typedef enum {
    SM_CHILD_REPLIED,   /* the child ended well; `reply` holds all that it wrote */
    SM_CHILD_CRASHED,   /* by signal `signal`, or with exit status `status` when that is 0 */
    SM_CHILD_TOO_LONG,  /* beyond the time limit; killed */
    SM_CHILD_TOO_LARGE, /* beyond the memory limit */
    SM_CHILD_FAILED,    /* no child or pipe could be made; `status` is errno */
} SmChildEnd;

typedef struct {
    SmChildEnd end;
    int signal, status;
    unsigned char *reply; /* the caller frees it */
    size_t size;
} SmChildResult;

/* What the child runs. It writes its reply to a descriptor, returns its exit status, 0 for
 * success and SM_CHILD_NO_MEMORY for lack of memory, and must not call exit(). Its standard
 * streams are /dev/null, its other descriptors closed, its signals at their defaults. */
typedef int (*SmChildBody)(void *argument, int reply);

enum { SM_CHILD_NO_MEMORY = 70 };

/* Runs `body` in a child and waits for it, at most limits->seconds. */
SmChildResult sm_child_run(SmChildBody body, void *argument, const SmChildLimits *limits);

#endif

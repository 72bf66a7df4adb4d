#ifndef HELFRICH_STATUS_H_
#define HELFRICH_STATUS_H_

#ifdef __cplusplus
/* Nobody may overlook a failure. */
#define HELFRICH_STATUS_MUST_BE_USED [[nodiscard]]
#else
#define HELFRICH_STATUS_MUST_BE_USED
#endif

/** What functions return that can fail; after a failure Helfrich_lastError() has the message. */
typedef enum HELFRICH_STATUS_MUST_BE_USED { Helfrich_Success = 0, Helfrich_Failure = 1 } Helfrich_Status;

#endif /*HELFRICH_STATUS_H_*/

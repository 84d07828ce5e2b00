/* As much of LinuxCNC's rtapi_app.h as abbe.c uses. */
#ifndef RTAPI_APP_H
#define RTAPI_APP_H

/* Each of these stands before a semicolon, where C asks for something. */
#define MODULE_AUTHOR(text) extern int hal_nothing
#define MODULE_DESCRIPTION(text) extern int hal_nothing
#define MODULE_LICENSE(text) extern int hal_nothing

int rtapi_app_main(void);
void rtapi_app_exit(void);

#endif

# Writes HEADER with the commit of SOURCE, "unknown" outside of git; only when it has changed.
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
                OUTPUT_VARIABLE commit ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
if(NOT commit)
    set(commit unknown)
endif()
set(text "#define ISORAST_COMMIT \"${commit}\"\n")
if(EXISTS ${HEADER})
    file(READ ${HEADER} known)
endif()
if(NOT text STREQUAL "${known}")
    file(WRITE ${HEADER} "${text}")
endif()

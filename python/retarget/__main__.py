"""`python -m retarget` runs the command `retarget`."""

from retarget._command import main

if __name__ == "__main__":
    main()

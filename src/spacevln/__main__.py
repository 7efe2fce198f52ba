"""``python -m spacevln``."""

from spacevln.cli import main

if __name__ == "__main__":
    main()

"""`python -m waxstudy`"""

from waxstudy.cli import main

if __name__ == "__main__":
    main()

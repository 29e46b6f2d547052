"""What `ipopt_baseline.py` is made of; `README.md` beside this file says what it does."""

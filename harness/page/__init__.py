"""What the pages of reports and of tuning share."""

//! From jobs to what became of them: what the server knows, else a worker, and once more where that may help.

use super::action::{Action, assemble};
use super::error::RemoteError;
use super::execute::{execute, known};
use super::group::Group;
use super::results::{Sent, collect};
use super::server::Remote;
use crate::remote::{Errand, JobFailure, Origin, Outcome};

/// Where results come from, and for each job why it has none.
type Results = (Origin, Vec<Option<JobFailure>>);

impl Remote {
    /// What becomes of the jobs of `group`; `running` is told when a worker begins.
    pub(super) async fn outcomes(
        &self,
        errand: &Errand<'_>,
        group: &Group<'_>,
        running: &(dyn Fn() + Sync),
    ) -> Vec<Outcome> {
        let mut moved = Vec::with_capacity(group.len());
        for (_, job) in group {
            moved.push((errand.check)(job).and_then(|()| job.moved()));
        }
        let pairs = group.iter().zip(&moved);
        let sent: Vec<Sent<'_>> =
            pairs.filter_map(|((_, job), moved)| Some(Sent { job, moved: moved.as_ref().ok()? })).collect();
        let results = self.results(errand, &sent, running).await;
        let mut outcomes = Vec::with_capacity(sent.len());
        match results {
            // One job that kills the tool takes no other with it.
            Err(RemoteError::Tool { .. }) if sent.len() > 1 => {
                for sent in sent.chunks(1) {
                    outcomes.extend(told(self.results(errand, sent, running).await, 1));
                }
            }
            results => outcomes.extend(told(results, sent.len())),
        }
        let mut outcomes = outcomes.into_iter();
        let of_job = |moved| match moved {
            Ok(_) => outcomes.next().unwrap_or_else(|| Err(JobFailure::from(&RemoteError::NoOutputs))),
            Err(error) => Err(JobFailure::from(&error)),
        };
        moved.into_iter().map(of_job).collect()
    }

    async fn results(
        &self,
        errand: &Errand<'_>,
        sent: &[Sent<'_>],
        running: &(dyn Fn() + Sync),
    ) -> Result<Results, RemoteError> {
        if let Some(error) = self.gone.get() {
            return Err(error.clone());
        }
        if sent.is_empty() {
            return Ok((Origin::Cached, Vec::new()));
        }
        let moved: Vec<_> = sent.iter().map(|sent| sent.moved).collect();
        let action = assemble(&moved, &self.tool, &self.options, &self.digests)?;
        let limit = self.options.timeout.unwrap_or(LIMIT);
        let results = tokio::time::timeout(limit, self.act(errand, sent, &action, running)).await;
        let results = results.unwrap_or(Err(RemoteError::Late { limit }));
        if let Err(error) = &results
            && error.is_gone()
        {
            // The first one stays.
            let _ = self.gone.set(error.clone());
        }
        results
    }

    async fn act(
        &self,
        errand: &Errand<'_>,
        sent: &[Sent<'_>],
        action: &Action,
        running: &(dyn Fn() + Sync),
    ) -> Result<Results, RemoteError> {
        let client = &self.client;
        client.count(|counts| counts.actions += 1);
        let mut skip_cache = false;
        if let Some(result) = client.attempts().at(|| known(action.digest, client)).await? {
            match collect(&result, sent, errand.folder, client).await {
                Ok(failures) if !failures.iter().flatten().any(|failure| failure.is_passing) => {
                    client.count(|counts| counts.cached += 1);
                    return Ok((Origin::Cached, failures));
                }
                Err(error @ RemoteError::Cache(_)) => return Err(error),
                // Blobs that are gone, failures that may pass, or a result of no use: a worker makes another.
                _ => skip_cache = true,
            }
        }
        let mut attempts = client.attempts();
        loop {
            let error = match self.run(errand, sent, action, &mut skip_cache, running).await {
                Ok(results) => return Ok(results),
                Err(error) => error,
            };
            if error.is_missing() {
                self.uploads.forget(&action.blobs);
            }
            attempts.after(error).await?;
        }
    }

    async fn run(
        &self,
        errand: &Errand<'_>,
        sent: &[Sent<'_>],
        action: &Action,
        skip_cache: &mut bool,
        running: &(dyn Fn() + Sync),
    ) -> Result<Results, RemoteError> {
        let client = &self.client;
        self.uploads.send(&action.blobs, client).await?;
        let response = execute(action.digest, *skip_cache, client, running).await?;
        // Whatever is wrong with this result: the next is to be another.
        *skip_cache = true;
        let origin = if response.cached_result { Origin::Cached } else { Origin::Executed };
        client.count(|counts| match origin {
            Origin::Cached => counts.cached += 1,
            Origin::Executed => counts.executed += 1,
        });
        let result = response.result.unwrap_or_default();
        let failures = collect(&result, sent, errand.folder, client).await?;
        Ok((origin, failures))
    }
}

/// What an action may take where the caller does not say.
const LIMIT: std::time::Duration = std::time::Duration::from_secs(3600);

/// The outcomes of `jobs` jobs.
fn told(results: Result<Results, RemoteError>, jobs: usize) -> Vec<Outcome> {
    match results {
        Ok((origin, failures)) => failures.into_iter().map(|failure| failure.map_or(Ok(origin), Err)).collect(),
        Err(error) => (0..jobs).map(|_| Err(JobFailure::from(&error))).collect(),
    }
}

impl From<&RemoteError> for JobFailure {
    fn from(error: &RemoteError) -> Self {
        Self { message: error.to_string(), is_passing: error.is_passing() }
    }
}
